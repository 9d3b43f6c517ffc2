// Reading what the service writes: meshes (OBJ) and rulings (CSV).

/**
 * @typedef {object} Model
 * @property {Float32Array} positions three a vertex, about `centre`
 * @property {Float32Array} values one a vertex: |twist| in degrees, or -1
 * @property {Uint32Array} indices three a triangle
 * @property {Float32Array} lines six a ruling, about `centre`
 * @property {number[]} centre middle of the box
 * @property {number} radius half its diagonal
 * @property {{name: string, first: number}[]} objects with their first triangle
 */

/**
 * A mesh, vertices apart for each object so that either side of a chine keeps
 * its own twist.
 * @param {string} text Wavefront OBJ
 * @param {Ruling[]} rulings
 * @returns {Model}
 */
export function readModel(text, rulings) {
  const places = [], corners = [], indices = [], objects = [];
  let own = new Map();
  const owners = [];
  const corner = (field) => {
    const place = parseInt(field, 10) - 1;
    let index = own.get(place);
    if (index === undefined) {
      index = corners.push(place) - 1;
      own.set(place, index);
      owners.push(Math.max(0, objects.length - 1));
    }
    return index;
  };
  for (const line of text.split("\n")) {
    if (line.startsWith("v ")) {
      const [, x, y, z] = line.split(" ");
      places.push([+x, +y, +z]);
    } else if (line.startsWith("f ")) {
      const [, a, b, c] = line.split(" ");
      indices.push(corner(a), corner(b), corner(c));
    } else if (line.startsWith("o ")) {
      objects.push({ name: line.slice(2).trim().replaceAll("_", " "), first: indices.length / 3 });
      own = new Map();
    }
  }
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const p of places) for (let k = 0; k < 3; k++) {
    low[k] = Math.min(low[k], p[k]);
    high[k] = Math.max(high[k], p[k]);
  }
  const centre = low.map((l, k) => (l + high[k]) / 2);
  const about = (p) => p.map((x, k) => x - centre[k]);
  return {
    positions: new Float32Array(corners.flatMap((place) => about(places[place]))),
    values: twists(corners.map((place) => places[place]), owners, rulings),
    indices: new Uint32Array(indices),
    lines: new Float32Array(rulings.flatMap((r) => [...about(r.from), ...about(r.to)])),
    centre,
    radius: Math.hypot(...high.map((h, k) => h - low[k])) / 2 || 1,
    objects,
  };
}

/**
 * The twist at each vertex: that of the ruling of its plate which ends
 * nearest. The mesh's objects are the plates in order.
 */
function twists(points, owners, rulings) {
  const plates = [];
  for (const r of rulings) (plates[r.plate] ??= []).push(r);
  return Float32Array.from(points, (p, i) => {
    let best = Infinity, value = -1;
    for (const r of plates[owners[i]] ?? []) {
      const away = Math.min(distance(p, r.from), distance(p, r.to));
      if (away < best) { best = away; value = Math.abs(r.twist); }
    }
    return value;
  });
}

const distance = (p, q) => (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2;

/**
 * @typedef {object} Ruling
 * @property {number} plate from 0, in the order of the table
 * @property {number[]} from
 * @property {number[]} to
 * @property {number} twist degrees, signed
 */

/**
 * The rulings of a ruling table; none out of another table.
 * @param {string} text RFC 4180
 * @returns {Ruling[]}
 */
export function readRulings(text) {
  const [head, ...records] = text.split("\r\n").filter(Boolean).map(fields);
  const column = (name) => head?.findIndex((h) => h === name || h.startsWith(`${name} (`)) ?? -1;
  const place = (end) => ["x", "y", "z"].map((axis) => column(`${end}_${axis}`));
  const from = place("from"), to = place("to"), twist = column("twist"), number = column("ruling");
  if ([...from, ...to, twist, number].includes(-1)) return [];
  // Plates may share a name; their rulings count from 1 each.
  let plate = -1;
  return records.map((r) => ({ plate: (plate += Number(r[number] === "1")), from: from.map((k) => +r[k]), to: to.map((k) => +r[k]), twist: +r[twist] }));
}

/** The fields of a record. @param {string} record */
function fields(record) {
  return [...record.matchAll(/("(?:[^"]|"")*"|[^,]*)(?:,|$)/g)]
    .map(([, field]) => (field.startsWith('"') ? field.slice(1, -1).replaceAll('""', '"') : field));
}
