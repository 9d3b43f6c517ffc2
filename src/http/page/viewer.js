// The surface in three dimensions: WebGL 2, one draw call for the triangles and
// one for the lines, drawn only when something changed.

/** @typedef {import("./model.js").Model} Model */

/** Colours of nothing, the limit, above it, and of what has no value. */
const RAMP = [[0.50, 0.86, 0.71], [0.08, 0.14, 0.52]], ABOVE = [0.82, 0.01, 0.11], PLAIN = [0.55, 0.66, 0.78];
const vec3 = (c) => `vec3(${c.map((x) => x.toFixed(3)).join(",")})`;

const VERTEX = `#version 300 es
in vec3 place; in float value;
uniform mat4 all; uniform mat4 turned;
out vec3 seen; out float worth;
void main() { seen = (turned * vec4(place, 1.0)).xyz; worth = value; gl_Position = all * vec4(place, 1.0); }`;

const FACES = `#version 300 es
precision highp float;
in vec3 seen; in float worth; uniform float limit; out vec4 colour;
void main() {
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  float light = 0.35 + 0.65 * abs(dot(normal, normalize(vec3(0.3, 0.4, 0.9))));
  float share = worth / limit;
  vec3 base = worth < 0.0 ? ${vec3(PLAIN)} : share > 1.0 ? ${vec3(ABOVE)} : mix(${vec3(RAMP[0])}, ${vec3(RAMP[1])}, share);
  colour = vec4(base * light, 1.0);
}`;

const LINES = `#version 300 es
precision mediump float; out vec4 colour;
void main() { colour = vec4(0.08, 0.10, 0.14, 1.0); }`;

/** Rulings lie in the surface: a little nearer to the eye they show whole. */
const RAISED = VERTEX.replace("place, 1.0); }", "place, 1.0); gl_Position.z -= 0.002; }");

function programme(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader) ?? "no shader");
    gl.attachShader(made, shader);
  }
  gl.bindAttribLocation(made, 0, "place");
  gl.bindAttribLocation(made, 1, "value");
  gl.linkProgram(made);
  const where = (name) => gl.getUniformLocation(made, name);
  return { made, all: where("all"), turned: where("turned"), limit: where("limit") };
}

function attribute(gl, place, data, size) {
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, size, gl.FLOAT, false, 0, 0);
}

/** Paints the scale from nothing to the limit and above, or to the largest. @param {HTMLCanvasElement} canvas @param {boolean} limited */
export function paintScale(canvas, limited) {
  const pen = canvas.getContext("2d");
  const css = (c) => `rgb(${c.map((x) => Math.round(255 * x)).join(" ")})`;
  const end = canvas.width * (limited ? 0.8 : 1);
  const ramp = pen.createLinearGradient(0, 0, end, 0);
  RAMP.forEach((c, i) => ramp.addColorStop(i, css(c)));
  pen.fillStyle = ramp;
  pen.fillRect(0, 0, end, canvas.height);
  if (!limited) return;
  pen.fillStyle = css(ABOVE);
  pen.fillRect(end, 0, canvas.width - end, canvas.height);
  pen.fillStyle = "#fff";
  pen.fillRect(end - 1, 0, 2, canvas.height);
}

/** A view of a model that can be turned, moved and zoomed. */
export class Viewer {
  #gl; #canvas; #model; #faces; #edges; #mesh; #rulings; #limit;
  #yaw = 0; #pitch = 0; #zoom = 1; #shift = [0, 0]; #due = false;
  #all = new Float32Array(16); #turned = new Float32Array(16);
  #held = new Map(); #spread = 0;
  /** Whether rulings are drawn. */
  showsLines = true;
  /** Called with what is under the pointer, or null. */
  onPoint = (_hit) => {};

  /** @param {HTMLCanvasElement} canvas @param {Model} model @param {number} limit in the unit of its values */
  constructor(canvas, model, limit) {
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("this browser offers no WebGL 2");
    this.#gl = gl; this.#canvas = canvas; this.#model = model; this.#limit = limit;
    this.#upload();
    this.#listen();
    this.home();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  #upload() {
    const gl = this.#gl, model = this.#model;
    this.#faces = programme(gl, VERTEX, FACES);
    this.#edges = programme(gl, RAISED, LINES);
    this.#mesh = gl.createVertexArray();
    gl.bindVertexArray(this.#mesh);
    attribute(gl, 0, model.positions, 3);
    attribute(gl, 1, model.values, 1);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, model.indices, gl.STATIC_DRAW);
    this.#rulings = gl.createVertexArray();
    gl.bindVertexArray(this.#rulings);
    attribute(gl, 0, model.lines, 3);
  }

  /** Back to the view of the whole, from abeam and a little above. */
  home() { this.#yaw = -0.6; this.#pitch = 0.45; this.#zoom = 1; this.#shift = [0, 0]; this.draw(); }

  /** Draws before the next frame. */
  draw() {
    if (this.#due) return;
    this.#due = true;
    requestAnimationFrame(() => { this.#due = false; this.#paint(); });
  }

  /** Turns z up; the eye looks along its own -z. */
  #place() {
    const r = this.#turned, a = this.#all, canvas = this.#canvas;
    const cy = Math.cos(this.#yaw), sy = Math.sin(this.#yaw), cp = Math.cos(this.#pitch), sp = Math.sin(this.#pitch);
    r.set([cy, sp * sy, -cp * sy, 0, -sy, sp * cy, -cp * cy, 0, 0, cp, sp, 0, 0, 0, 0, 1]);
    const wide = canvas.width / canvas.height;
    // The whole fits the narrow side; a long hull may fill more of a wide one.
    const fit = wide < 1 ? wide : Math.min(wide, 1.7);
    const scale = this.#zoom * fit / this.#model.radius;
    const size = [scale / wide, scale, -0.25 / this.#model.radius];
    for (let c = 0; c < 3; c++) for (let k = 0; k < 3; k++) a[4 * c + k] = r[4 * c + k] * size[k];
    a[12] = this.#shift[0]; a[13] = this.#shift[1]; a[15] = 1;
  }

  #paint() {
    const gl = this.#gl, canvas = this.#canvas, dense = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(canvas.clientWidth * dense)), height = Math.max(1, Math.round(canvas.clientHeight * dense));
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    this.#place();
    gl.viewport(0, 0, width, height);
    gl.clearColor(0.96, 0.97, 0.98, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    this.#use(this.#faces, this.#mesh);
    gl.drawElements(gl.TRIANGLES, this.#model.indices.length, gl.UNSIGNED_INT, 0);
    if (!this.showsLines || this.#model.lines.length === 0) return;
    this.#use(this.#edges, this.#rulings);
    gl.drawArrays(gl.LINES, 0, this.#model.lines.length / 3);
  }

  #use(programme, array) {
    const gl = this.#gl;
    gl.useProgram(programme.made);
    gl.bindVertexArray(array);
    gl.uniformMatrix4fv(programme.all, false, this.#all);
    gl.uniformMatrix4fv(programme.turned, false, this.#turned);
    gl.uniform1f(programme.limit, this.#limit);
  }

  #turn(x, y) { this.#yaw += x; this.#pitch = Math.min(1.57, Math.max(-1.57, this.#pitch + y)); this.draw(); }
  #move(x, y) { this.#shift[0] += x; this.#shift[1] += y; this.draw(); }
  #scale(by) { this.#zoom = Math.min(200, Math.max(0.2, this.#zoom * by)); this.draw(); }

  #listen() {
    const canvas = this.#canvas;
    canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); this.#held.set(e.pointerId, [e.clientX, e.clientY]); this.#spread = 0; });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (e) => { this.#held.delete(e.pointerId); this.#spread = 0; });
    canvas.addEventListener("pointermove", (e) => this.#drag(e));
    canvas.addEventListener("pointerleave", () => this.onPoint(null));
    canvas.addEventListener("wheel", (e) => { e.preventDefault(); this.#scale(Math.exp(-e.deltaY / 600)); }, { passive: false });
    canvas.addEventListener("keydown", (e) => this.#key(e));
  }

  #drag(event) {
    const before = this.#held.get(event.pointerId);
    if (!before) { this.onPoint(this.#under(event)); return; }
    const [x, y] = [event.clientX - before[0], event.clientY - before[1]];
    this.#held.set(event.pointerId, [event.clientX, event.clientY]);
    const { clientWidth, clientHeight } = this.#canvas;
    if (this.#held.size > 1) {
      const [a, b] = [...this.#held.values()];
      const spread = Math.hypot(a[0] - b[0], a[1] - b[1]);
      if (this.#spread > 0) this.#scale(spread / this.#spread);
      this.#spread = spread;
      this.#move(x / clientWidth, -y / clientHeight);
    } else if (event.shiftKey || event.buttons & 6) this.#move(2 * x / clientWidth, -2 * y / clientHeight);
    else this.#turn(x / 150, y / 150);
  }

  #key(event) {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (way && event.shiftKey) this.#move(way[0] / 10, -way[1] / 10);
    else if (way) this.#turn(way[0] / 10, way[1] / 10);
    else if (event.key === "+" || event.key === "=") this.#scale(1.2);
    else if (event.key === "-") this.#scale(1 / 1.2);
    else if (event.key === "Home") this.home();
    else return;
    event.preventDefault();
  }

  /** The nearest triangle at the pointer: its object, place and value. */
  #under(event) {
    const box = this.#canvas.getBoundingClientRect(), m = this.#all, p = this.#model.positions, index = this.#model.indices;
    const x = 2 * (event.clientX - box.left) / box.width - 1, y = 1 - 2 * (event.clientY - box.top) / box.height;
    const on = (i, k) => m[k] * p[3 * i] + m[4 + k] * p[3 * i + 1] + m[8 + k] * p[3 * i + 2] + m[12 + k];
    let best = null, nearest = Infinity;
    for (let t = 0; t < index.length; t += 3) {
      const a = index[t], b = index[t + 1], c = index[t + 2];
      const ax = on(a, 0) - x, ay = on(a, 1) - y, bx = on(b, 0) - x, by = on(b, 1) - y, cx = on(c, 0) - x, cy = on(c, 1) - y;
      const u = bx * cy - cx * by, v = cx * ay - ax * cy, w = ax * by - bx * ay, sum = u + v + w;
      if (sum === 0 || (u * sum < 0) || (v * sum < 0) || (w * sum < 0)) continue;
      const depth = (u * on(a, 2) + v * on(b, 2) + w * on(c, 2)) / sum;
      if (depth < nearest) { nearest = depth; best = { t, corners: [a, b, c], shares: [u / sum, v / sum, w / sum] }; }
    }
    return best && this.#tell(best);
  }

  #tell({ t, corners, shares }) {
    const mix = (of) => corners.reduce((sum, i, k) => sum + shares[k] * of(i), 0);
    const place = [0, 1, 2].map((k) => this.#model.centre[k] + mix((i) => this.#model.positions[3 * i + k]));
    return { name: this.#model.objects.findLast((o) => o.first <= t / 3)?.name ?? "", place, value: mix((i) => this.#model.signed[i]) };
  }
}
