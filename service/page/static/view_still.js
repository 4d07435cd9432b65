// @ts-check
/** A still picture of a gear unit where WebGL2 is missing: the same meshes, seen by the same camera, drawn point by point. */

import { make } from "./elements.js";
import { Camera } from "./view_camera.js";
import { COLORS, GEARS } from "./view_pair.js";
import { toothMesh } from "./view_teeth.js";

/** @typedef {{values: Float32Array, indices: Uint32Array, color: number[], marked?: boolean, place: (point: number[]) => number[], width?: number}} Solid */
/** @typedef {{data: Uint8ClampedArray, depth: Float32Array}} Layer what is in front at each point: its color and how far away it is */

const WIDTH = 7; // numbers of a vertex, but for those of a housing
const HULL = { width: 13, color: [0.5, 0.55, 0.6], opacity: 0.3 };
const LIGHT = [0.1, 0.6, 0.1]; // added to the direction of the eye
const BEFORE = 4; // depth by which what is marked is seen through all else
export const STILL = "A still picture of the unit: this browser has no WebGL2, in which it moves.";

/** @param {number} angle @returns {(point: number[]) => number[]} a rotation about z */
function about(angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return ([x, y, z]) => [c * x - s * y, s * x + c * y, z];
}

/** Every solid of a unit with where its vertices stand in the scene. @param {any} unit @returns {Generator<Solid>} */
function* solidsOf(unit) {
  for (const { name, shaft, mesh, color } of unit.parts) {
    yield { ...mesh, color, marked: name === unit.marked, place: (point) => point.map((value, k) => value + shaft.origin_mm[k]) };
  }
  for (const { on, pair, angle, to } of unit.stages) {
    const turned = about(angle);
    for (const name of GEARS) {
      const gear = pair.outline[name];
      const solid = { ...toothMesh(gear, pair.outline.internal && name === "wheel", true), color: (pair.colors ?? COLORS)[name], marked: on[name].name === unit.marked };
      const middle = 0.5 * (gear.face_mm[0] + gear.face_mm[1]);
      for (let tooth = 0; tooth < gear.teeth; tooth += 1) {
        const at = (Math.PI / 180) * gear.angle_deg + (gear.turn * 2 * Math.PI * tooth) / gear.teeth;
        const place = (point) => {
          const [x, y, z] = about(at + (Math.PI / 180) * gear.twist_deg_per_mm * (point[2] - middle))(point);
          return turned([x + gear.centre_mm[0], y + gear.centre_mm[1], z]).map((value, k) => value + to[name][k]);
        };
        yield { ...solid, place };
      }
    }
  }
}

/** What is in front at each point of a picture. */
class Picture {
  /** @param {HTMLCanvasElement} canvas @param {any} unit */
  constructor(canvas, unit) {
    Object.assign(canvas, { width: Math.round(devicePixelRatio * canvas.clientWidth), height: Math.round(devicePixelRatio * canvas.clientHeight) });
    const camera = new Camera();
    unit.frame(camera);
    this.view = camera.matrix(canvas.width / canvas.height);
    const light = camera.back.map((value, k) => value + LIGHT[k]);
    this.light = light.map((value) => value / Math.hypot(...light));
    this.context = canvas.getContext("2d");
    this.image = this.context.createImageData(canvas.width, canvas.height);
    const front = this.layer(this.image);
    for (const solid of solidsOf(unit)) this.solid(solid, front);
    if (unit.housing) this.through({ ...unit.housing.mesh, ...HULL, place: (point) => point }, front);
    this.context.putImageData(this.image, 0, 0);
  }

  /** @returns {Layer} */
  layer({ data, width, height }) {
    return { data, depth: new Float32Array(width * height).fill(Infinity) };
  }

  /** Draw what the rest is seen through. @param {Solid & {opacity: number}} solid @param {Layer} front */
  through(solid, front) {
    const over = this.layer(this.context.createImageData(this.image));
    this.solid(solid, over);
    over.depth.forEach((depth, at) => {
      if (depth >= front.depth[at]) return;
      const [below, own] = [front.data.subarray(4 * at, 4 * at + 4), over.data.subarray(4 * at, 4 * at + 3)];
      const part = solid.opacity / (below[3] ? 1 : solid.opacity); // on nothing its own color, seen through
      own.forEach((value, k) => { below[k] += part * (value - below[k]); });
      below[3] ||= 255 * solid.opacity;
    });
  }

  /** @param {number[]} point @returns {number[]} across and down in pixels, depth */
  seen([x, y, z]) {
    const [across, up, depth, w] = [0, 1, 2, 3].map((k) => this.view[k] * x + this.view[4 + k] * y + this.view[8 + k] * z + this.view[12 + k]);
    return [0.5 * (1 + across / w) * this.image.width, 0.5 * (1 - up / w) * this.image.height, depth / w];
  }

  /** @param {Solid} solid @param {Layer} layer */
  solid({ values, indices, color, marked, place, width = WIDTH }, layer) {
    const points = Array.from({ length: values.length / width }, (_, k) => place([...values.subarray(width * k, width * k + 3)]));
    const pixels = points.map((point) => this.seen(point));
    for (let k = 0; k < indices.length; k += 3) {
      const corners = indices.subarray(k, k + 3);
      const [a, b, c] = [...corners].map((corner) => pixels[corner]);
      const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      if (!(area < 0)) continue; // turned away: rows run down
      const lit = this.lit(...[...corners].map((corner) => points[corner]));
      this.facet([a, b, c], area, color.map((value) => Math.min(255 * value * lit, 255)), marked ? BEFORE : 0, layer);
    }
  }

  /** How bright a facet is. @param {number[]} a @param {number[]} b @param {number[]} c */
  lit(a, b, c) {
    const [u, v] = [b, c].map((corner) => corner.map((value, k) => value - a[k]));
    const across = [0, 1, 2].map((k) => u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    const facing = across.reduce((sum, value, k) => sum + value * this.light[k], 0) / (Math.hypot(...across) || 1);
    return 0.34 + 0.66 * Math.max(facing, 0);
  }

  /** @param {number[][]} corners @param {number} area twice that of the facet @param {number[]} color @param {number} before @param {Layer} layer */
  facet([a, b, c], area, color, before, { data, depth }) {
    const { width, height } = this.image;
    const [low, high] = [0, 1].map((k) => [Math.max(Math.ceil(Math.min(a[k], b[k], c[k]) - 0.5), 0), Math.min(Math.floor(Math.max(a[k], b[k], c[k]) - 0.5), (k ? height : width) - 1)]);
    for (let row = high[0]; row <= high[1]; row += 1) {
      for (let column = low[0]; column <= low[1]; column += 1) {
        const [x, y] = [column + 0.5 - a[0], row + 0.5 - a[1]];
        const second = (x * (c[1] - a[1]) - y * (c[0] - a[0])) / area;
        const third = (y * (b[0] - a[0]) - x * (b[1] - a[1])) / area;
        const ahead = a[2] + second * (b[2] - a[2]) + third * (c[2] - a[2]) - before;
        const at = row * width + column;
        if (second < 0 || third < 0 || second + third > 1 || ahead >= depth[at]) continue;
        depth[at] = ahead;
        data.set([...color, 255], 4 * at);
      }
    }
  }
}

/** A canvas with the still picture of a unit, drawn as soon as it has a size. @param {any} unit @param {string} words */
export function stillOf(unit, words) {
  const canvas = /** @type {HTMLCanvasElement} */ (make("canvas", { class: "view view-still", role: "img", "aria-label": words }));
  new ResizeObserver(() => {
    if (canvas.clientWidth && canvas.clientHeight) new Picture(canvas, unit);
    canvas.dataset.drawn = "yes";
  }).observe(canvas);
  return canvas;
}
