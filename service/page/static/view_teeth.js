// @ts-check
/** One tooth of a gear in space, extruded from its transverse outline; the shader twists, bends and repeats it. */

import { Meshing } from "./view_gl.js";

const SHARP = 0.85; // cosine of the angle between neighboring normals at an edge
const TWIST = 0.06; // rad between layers at most
const OVERLAP = 1e-4; // rad
const COARSE = 0.2; // rad between the normals of neighboring points of a tooth that nobody looks at closely
const ALONG = 6; // layers at least: a bent tooth curves over the face

/** @typedef {{teeth: number, tooth_mm: number[][], radius_mm: Record<string, number>, angle_deg: number, centre_mm: number[], turn: number, face_mm: number[], twist_deg_per_mm: number}} Gear */

/** The points of an outline with their normals away from the material, two at an edge: [before, after]. */
function columns(points, outwards) {
  const normals = points.slice(1).map(([x, y], k) => {
    const [dx, dy] = [x - points[k][0], y - points[k][1]];
    const length = Math.hypot(dx, dy) || 1;
    return [(-outwards * dy) / length, (outwards * dx) / length];
  });
  return points.map((point, k) => {
    const [a, b] = [normals[Math.max(k - 1, 0)], normals[Math.min(k, normals.length - 1)]];
    if (a[0] * b[0] + a[1] * b[1] < SHARP) return { point, normals: [a, b] };
    const size = Math.hypot(a[0] + b[0], a[1] + b[1]);
    const mean = [(a[0] + b[0]) / size, (a[1] + b[1]) / size];
    return { point, normals: [mean, mean] };
  });
}

/** Fewer points: edges, ends, and where the normal has turned since the last one. @param {number[][]} points @param {number} turn rad */
function thinned(points, turn) {
  const marked = columns(points, 1);
  let last = marked[0].normals[1];
  return points.filter((_, k) => {
    const [own, next] = marked[k].normals;
    const kept = k % (points.length - 1) === 0 || own !== next || last[0] * own[0] + last[1] * own[1] < Math.cos(turn);
    if (kept) last = next;
    return kept;
  });
}

/** Neighbors overlap by a hair: no light falls between them. @param {number[][]} points from left to right */
function seamless(points) {
  const turned = ([x, y], angle) => [x + angle * y, y - angle * x];
  return [turned(points[0], -OVERLAP), ...points.slice(1, -1), turned(points[points.length - 1], OVERLAP)];
}

/**
 * The roll length in mm of a point of the flank that carries, -1 elsewhere.
 * @param {Gear} gear @param {number[]} point @param {number[]} normal @param {number} side of the tooth, in x
 */
function rollAt({ radius_mm: { base } }, [x, y], normal, side) {
  const radius = Math.hypot(x, y);
  const radial = Math.abs(normal[0] * x + normal[1] * y) / radius;
  return side * x > 0 && radius > base && radial < SHARP ? Math.sqrt(radius ** 2 - base ** 2) : -1;
}

/**
 * Vertices by place (transverse coordinates of the untwisted tooth on +y, z from the pinion's mid-face), normal and roll length.
 * @param {Gear} gear @param {boolean} ring @param {boolean} coarse
 */
export function toothMesh(gear, ring, coarse) {
  const points = seamless(coarse ? thinned(gear.tooth_mm, COARSE) : gear.tooth_mm);
  const made = new Meshing();
  const outwards = ring ? -1 : 1;
  const [low, high] = gear.face_mm;
  const twist = (Math.abs(gear.twist_deg_per_mm) * (high - low) * Math.PI) / 180;
  const layers = Math.max(coarse ? 2 : ALONG, Math.ceil(twist / (coarse ? 2 * TWIST : TWIST)));
  const depths = Array.from({ length: layers + 1 }, (_, k) => low + ((high - low) * k) / layers);
  const column = (point, normal, mark) => depths.map((z) => made.vertex([...point, z], [...normal, 0], mark));
  /** @type {number[] | undefined} */
  let before;
  for (const { point, normals } of columns(points, outwards)) {
    const [own, next] = normals.map((normal) => column(point, normal, rollAt(gear, point, normal, outwards)));
    if (before) strip(made, before, own);
    before = next;
  }
  body(made, points, gear, outwards);
  return made.mesh;
}

/** Both ends of the face, across the root circle, below which nothing bends; and the surface the gear is held by. @param {Meshing} made */
function body(made, points, { face_mm: ends, radius_mm: { root, held } }, outwards) {
  const at = (radius) => points.map((point) => point.map((value) => (value * radius) / Math.hypot(...point)));
  const [below, seat] = [at(root), at(held)];
  ends.forEach((z, end) => {
    const strips = [points, below, seat].map((row) => row.map((point) => made.vertex([...point, z], [0, 0, end ? 1 : -1])));
    strips.slice(1).forEach((inner, k) => strip(made, strips[k], inner));
  });
  const [near, far] = ends.map((z) => seat.map((point) => made.vertex([...point, z], [...point.map((value) => (-outwards * value) / held), 0])));
  strip(made, near, far);
}

/** @param {Meshing} made @param {number[]} first @param {number[]} second rows of vertices */
function strip(made, first, second) {
  for (let k = 1; k < first.length; k += 1) made.quad(first[k - 1], second[k - 1], first[k], second[k]);
}
