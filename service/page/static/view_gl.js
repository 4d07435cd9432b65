// @ts-check
/** What the three-dimensional views need of WebGL2: programs, meshes in buffers, tables as textures. */

/** @typedef {{array: WebGLVertexArrayObject, count: number, marked: number, buffers: WebGLBuffer[]}} Held a mesh in buffers */
/** @typedef {{values: Float32Array, indices: Uint32Array, marked: number}} Mesh seven numbers a vertex: place, normal, mark; the last `marked` indices are of triangles with marks */

/** What the page draws on, null where the browser has no WebGL2: made while its other scripts are on their way, as that takes long. */
export const context = document.createElement("canvas").getContext("webgl2", { antialias: false, stencil: true, powerPreference: "low-power" });

const WIDTH = 7; // numbers of a vertex
const PARTS = [3, 3, 1]; // place, normal, mark

/**
 * @param {WebGL2RenderingContext} gl @param {string} vertex @param {string} fragment
 * @returns {{program: WebGLProgram, at: Record<string, WebGLUniformLocation>}} a program and where its uniforms are
 */
export function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of /** @type {[number, string][]} */ ([[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]])) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, `#version 300 es\nprecision highp float;\nprecision highp int;\n${source}`);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
    gl.deleteShader(shader);
  }
  ["place", "normal", "mark", "real", "imaginary"].forEach((name, k) => gl.bindAttribLocation(made, k, name));
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made) ?? "no program");
  const count = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS);
  const names = Array.from({ length: count }, (_, k) => gl.getActiveUniform(made, k).name);
  return { program: made, at: Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(made, name)])) };
}

/** @param {WebGL2RenderingContext} gl @param {Mesh} mesh @param {number[]} [parts] numbers of each attribute of a vertex @returns {Held} */
export function held(gl, { values, indices, marked }, parts = PARTS) {
  const width = parts.reduce((sum, size) => sum + size, 0);
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  const [vertices, order] = [gl.createBuffer(), gl.createBuffer()];
  gl.bindBuffer(gl.ARRAY_BUFFER, vertices);
  gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
  let offset = 0;
  parts.forEach((size, k) => {
    gl.enableVertexAttribArray(k);
    gl.vertexAttribPointer(k, size, gl.FLOAT, false, 4 * width, 4 * offset);
    offset += size;
  });
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, order);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  return { array, count: indices.length, marked, buffers: [vertices, order] };
}

/** @param {WebGL2RenderingContext} gl @param {Held[]} meshes */
export function freed(gl, meshes) {
  for (const { array, buffers } of meshes) {
    gl.deleteVertexArray(array);
    for (const buffer of buffers) gl.deleteBuffer(buffer);
  }
}

/**
 * Put rows of two tables side by side into a texture that is interpolated between its entries.
 * @param {WebGL2RenderingContext} gl @param {WebGLTexture} texture @param {number[][]} first @param {number[][]} second
 */
export function tables(gl, texture, first, second) {
  const [height, width] = [first.length, first[0].length];
  const values = new Float32Array(2 * width * height);
  first.forEach((row, i) => row.forEach((value, k) => values.set([value, second[i][k]], 2 * (i * width + k))));
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG16F, width, height, 0, gl.RG, gl.FLOAT, values);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.LINEAR);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
}

/** Vertices and triangles as they are put together. */
export class Meshing {
  constructor() {
    /** @type {number[]} */
    this.values = [];
    /** @type {number[]} */
    this.indices = [];
    /** @type {number[]} */
    this.marked = [];
  }

  /** @param {number[]} place @param {number[]} normal @param {number} [mark] @returns {number} its index */
  vertex(place, normal, mark = -1) {
    return this.values.push(...place, ...normal, mark) / WIDTH - 1;
  }

  /** Two triangles between the edges a, b and c, d, seen from where their normals point. */
  quad(a, b, c, d) {
    const at = (vertex, from) => this.values.slice(WIDTH * vertex + from, WIDTH * vertex + from + 3);
    const [p, q, r, s] = [a, b, c, d].map((vertex) => at(vertex, 0));
    const [u, v] = [s.map((value, k) => value - p[k]), r.map((value, k) => value - q[k])];
    const across = [0, 1, 2].map((k) => u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    const normal = at(a, 3).map((value, k) => value + at(d, 3)[k]);
    const ahead = across.reduce((sum, value, k) => sum + value * normal[k], 0) > 0;
    const marks = [a, b, c, d].every((vertex) => this.values[WIDTH * vertex + WIDTH - 1] >= 0);
    (marks ? this.marked : this.indices).push(...(ahead ? [a, b, c, c, b, d] : [a, c, b, b, c, d]));
  }

  /** @returns {Mesh} */
  get mesh() {
    return { values: new Float32Array(this.values), indices: new Uint32Array([...this.indices, ...this.marked]), marked: this.marked.length };
  }
}
