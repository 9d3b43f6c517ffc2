// Reading what the service writes: scenes (binary glTF).

/**
 * @typedef {object} Model
 * @property {Float32Array} positions three a vertex, about `centre`
 * @property {Float32Array} values one a vertex: the magnitude of its number, or -1
 * @property {Float32Array} signed one a vertex: the number itself, or NaN
 * @property {Uint32Array} indices three a triangle
 * @property {Float32Array} lines six a piece of line, about `centre`
 * @property {number[]} centre middle of the box
 * @property {number} radius half its diagonal
 * @property {{name: string, first: number}[]} objects with their first triangle
 * @property {Meaning} meaning what the numbers are
 */

/**
 * @typedef {object} Meaning
 * @property {string | null} quantity
 * @property {string | null} unit
 * @property {number | null} limit
 * @property {number} largest
 * @property {string} units of the positions
 */

const MAGIC = 0x46546c67, LINES = 1, UNSIGNED = 5125;

/**
 * A scene as the service writes it: one level of nodes, positions about the
 * centre that the root's extras give, in the unit that they name.
 * @param {ArrayBuffer} buffer @returns {Model}
 */
export function readModel(buffer) {
  const head = new DataView(buffer);
  if (head.getUint32(0, true) !== MAGIC) throw new Error("the scene is no binary glTF");
  const length = head.getUint32(12, true);
  const tree = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 20, length)));
  const read = reader(buffer, tree, 28 + length);
  const meaning = tree.nodes[0].extras;
  const positions = [], signed = [], indices = [], lines = [], objects = [];
  let vertices = 0, triangles = 0;
  for (const node of tree.nodes.slice(1)) {
    const part = tree.meshes[node.mesh].primitives[0];
    const places = read(part.attributes.POSITION), order = read(part.indices);
    if (part.mode === LINES) {
      lines.push(Float32Array.from({ length: 3 * order.length }, (_, i) => places[3 * order[(i / 3) | 0] + (i % 3)]));
      continue;
    }
    const count = places.length / 3;
    objects.push({ name: node.name, first: triangles });
    positions.push(places);
    signed.push(part.attributes._VALUE === undefined ? new Float32Array(count).fill(NaN) : read(part.attributes._VALUE));
    indices.push(order.map((i) => i + vertices));
    vertices += count;
    triangles += order.length / 3;
  }
  const numbers = joined(Float32Array, signed);
  const model = { positions: joined(Float32Array, positions), lines: joined(Float32Array, lines) };
  return {
    ...model,
    signed: numbers,
    values: numbers.map((v) => (Number.isNaN(v) ? -1 : Math.abs(v))),
    indices: joined(Uint32Array, indices),
    centre: meaning.centre,
    radius: reach(model.positions) || 1,
    objects,
    meaning,
  };
}

/** Accessors as arrays over the binary chunk, which begins at `start`. */
const reader = (buffer, tree, start) => (index) => {
  const { bufferView, componentType, count, type } = tree.accessors[index];
  const kind = componentType === UNSIGNED ? Uint32Array : Float32Array;
  return new kind(buffer, start + tree.bufferViews[bufferView].byteOffset, count * (type === "VEC3" ? 3 : 1));
};

function joined(kind, arrays) {
  const all = new kind(arrays.reduce((sum, a) => sum + a.length, 0));
  let at = 0;
  for (const array of arrays) { all.set(array, at); at += array.length; }
  return all;
}

/** Half the diagonal of the box. @param {Float32Array} positions */
function reach(positions) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i++) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  return positions.length ? Math.hypot(...high.map((h, k) => h - low[k])) / 2 : 0;
}
