// @ts-check
/** A gear unit as its scene has it: shafts and bearings as bodies of revolution, gears with their teeth, all in motion. */

import { ask, patiently } from "./api.js";
import { caseOf } from "./orders.js";
import { same } from "./schema.js";
import { freed, held, Meshing } from "./view_gl.js";
import { hullOf, Motion, STATIONS } from "./view_motion.js";
import { COLORS as OF_PAIR, GEARS, put, RollingPair } from "./view_pair.js";

const SIDES = 32; // of a body of revolution
const SPEED = 0.5; // base pitches a second of the first mesh
const COLORS = { shaft: [0.62, 0.64, 0.67], bearing: [0.42, 0.46, 0.52] };
const MARKED = [0.90, 0.62, 0.0];
const BUSHING = 0.7; // its height over the wall of its shaft where a scene has no catalog
const WIDTH = 0.55; // of a bearing over its height twice
const STILL = { values: new Float32Array(12), stations: [0, 1e9, 0] };

/** @typedef {{name: string, origin_mm: number[], length_mm: number, diameter_mm?: number, sections?: {length_mm: number, outer_diameter_mm: number, bore_diameter_mm?: number}[]}} Shaft */

/** A ring about z. @param {Meshing} made @param {number} inner radius @param {number} outer @param {number} [layers] of its wall, between which it bends */
function ring(made, inner, outer, low, high, layers = 1) {
  const line = (radius, z, up = 0, side = 1) => Array.from({ length: SIDES + 1 }, (_, k) => {
    const [x, y] = [Math.cos, Math.sin].map((of) => of((2 * Math.PI * k) / SIDES));
    return made.vertex([radius * x, radius * y, z], up ? [0, 0, up] : [side * x, side * y, 0]);
  });
  const walls = Array.from({ length: layers + 1 }, (_, k) => line(outer, low + ((high - low) * k) / layers));
  const strips = walls.slice(1).map((wall, k) => [walls[k], wall]);
  for (const [z, up] of [[low, -1], [high, 1]]) strips.push([line(inner, z, up), line(outer, z, up)]);
  if (inner) strips.push([line(inner, low, 0, -1), line(inner, high, 0, -1)]);
  for (const [a, b] of strips) for (let k = 1; k <= SIDES; k += 1) made.quad(a[k - 1], b[k - 1], a[k], b[k]);
}

/** @param {Shaft} shaft */
const sectionsOf = (shaft) => shaft.sections ?? [{ length_mm: shaft.length_mm, outer_diameter_mm: shaft.diameter_mm ?? shaft.length_mm / 8 }];

/** The section of a shaft at a place along it. @param {Shaft} shaft */
function sectionAt(shaft, place) {
  let end = 0;
  const section = sectionsOf(shaft).find(({ length_mm: length }) => (end += length) >= place - 1e-9);
  return section ?? sectionsOf(shaft).at(-1);
}

/** @param {Shaft} shaft */
function shaftMesh(shaft) {
  const made = new Meshing();
  let low = 0;
  for (const { length_mm: length, outer_diameter_mm: diameter, bore_diameter_mm: bore = 0 } of sectionsOf(shaft)) {
    ring(made, bore / 2, diameter / 2, low, low + length, Math.ceil((length / shaft.length_mm) * (STATIONS - 1)));
    low += length;
  }
  return made.mesh;
}

/** @param {any} bearing @param {Shaft} shaft */
function bearingMesh({ position_mm: place, catalog }, shaft) {
  const { outer_diameter_mm: diameter, bore_diameter_mm: bore = 0 } = sectionAt(shaft, place);
  const [inner, outer] = [diameter / 2, catalog ? catalog.outside_diameter_mm / 2 : diameter / 2 + (BUSHING * (diameter - bore)) / 2];
  const half = WIDTH * (outer - inner);
  const made = new Meshing();
  ring(made, inner, outer, place - half, place + half);
  return made.mesh;
}

/** The pinion and the wheel of a mesh. @param {any} mesh @param {Map<string, any>} gears by their names */
const gearsOf = ({ driver, driven, wheel_drives: reversed }, gears) => ({ pinion: gears.get(reversed ? driven : driver), wheel: gears.get(reversed ? driver : driven) });

/** @param {{face_mm: number[]}} gear */
const middleOf = ({ face_mm: [low, high] }) => 0.5 * (low + high);

const mapped = (values, to) => Object.fromEntries(Object.entries(values).map(([name, value]) => [name, to(value)]));

const bearingsOf = (scene) => [...(scene.rolling_bearings ?? []), ...(scene.bushings ?? [])];

/** What is drawn of a scene but for the places on shafts. @param {any} scene */
function unplaced({ shafts, gears = [], meshes, rolling_bearings: rolling = [], bushings = [] }) {
  const parts = [gears, rolling, bushings].map((list) => list.map((part) => ({ ...part, position_mm: 0 })));
  return { shafts, meshes, parts };
}

/** By columns: turned about z, then moved. @param {number} angle @param {number[]} to */
function placement(angle, [x, y, z]) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, x, y, z, 1];
}

/** @param {Float32Array} a @param {number[]} b both by columns */
const product = (a, b) => Float32Array.from({ length: 16 }, (_, k) => {
  const [column, row] = [Math.floor(k / 4), k % 4];
  return [0, 1, 2, 3].reduce((sum, i) => sum + a[4 * i + row] * b[4 * column + i], 0);
});

/** @implements {import("./view_stage.js").Subject} */
export class Gearbox {
  /**
   * @param {any} scene
   * @param {{mesh: any, outline: any}[]} stages in the order of the power
   * @param {(mesh: any) => void} open what is done with a mesh that is clicked
   */
  constructor(scene, stages, open) {
    this.open = open;
    /** @type {((part: string, position: number) => void) | null} what moves a part along its shaft; null: nothing does */
    this.slid = null;
    this.position = 0;
    /** @type {Motion | null} */
    this.motion = null;
    /** @type {import("./view_motion.js").Surface | null} that of its housing where it stands */
    this.solid = null;
    /** @type {ReturnType<typeof hullOf> | null} */
    this.housing = null;
    this.stand(scene, stages.map((stage) => ({ ...stage, pair: new RollingPair() })));
  }

  /** Let parts stand where a scene has them. */
  stand(scene, stages) {
    this.scene = scene;
    this.shafts = new Map((scene.shafts ?? []).map((shaft) => [shaft.name, { ...shaft, origin_mm: shaft.origin_mm ?? [0, 0, 0] }]));
    const gears = new Map((scene.gears ?? []).filter(({ shaft }) => this.shafts.has(shaft)).map((gear) => [gear.name, gear]));
    const whole = stages.map((stage) => ({ ...stage, on: gearsOf(stage.mesh, gears) })).filter(({ on }) => GEARS.every((name) => on[name]));
    /** @type {Map<string, number>} turns of shafts in rad a base pitch of the first mesh, counter-clockwise */
    this.turns = new Map();
    this.stages = whole.map((stage) => this.stage(stage));
  }

  /** Follow a scene whose parts stand elsewhere on their shafts and are the same otherwise. @returns {boolean} whether it is one */
  follow(scene) {
    if (!this.bodies || !same(unplaced(scene), unplaced(this.scene))) return false;
    this.move(null);
    this.stand(scene, this.stages);
    freed(this.gl, this.bodies.map(({ mesh }) => mesh));
    this.embody();
    return true;
  }

  stage({ mesh, outline, pair, on }) {
    const [one, other] = GEARS.map((name) => this.shafts.get(on[name].shaft));
    const [x, y] = [0, 1].map((k) => other.origin_mm[k] - one.origin_mm[k]);
    const angle = Math.atan2(y, x) + (outline.internal ? 1 : -1) * (Math.PI / 2);
    const { pinion, wheel } = outline;
    const height = { pinion: one.origin_mm[2] + on.pinion.position_mm, wheel: other.origin_mm[2] + on.wheel.position_mm - middleOf(wheel) };
    const to = mapped(height, (z) => [one.origin_mm[0], one.origin_mm[1], z]);
    const lead = wheel.twist_deg_per_mm * (height.wheel - height.pinion); // teeth fit wherever the wheel stands
    const step = (-2 * Math.PI) / pinion.teeth; // of the pinion, a base pitch
    const turned = this.turns.get(one.name) ?? step;
    this.turns.set(one.name, turned);
    this.turns.set(other.name, (turned / step) * wheel.turn * ((2 * Math.PI) / wheel.teeth));
    pair.outline = { ...outline, wheel: { ...wheel, angle_deg: wheel.angle_deg + lead } };
    return { mesh, outline, pair, place: mapped(to, (place) => placement(angle, place)), ratio: turned / step, on, angle, to };
  }

  /** Let it move by a result. @param {import("./view_motion.js").UnitMotion | null} motion null: it stands */
  move(motion) {
    const discs = this.stages.flatMap(({ pair, on }) => GEARS.map((name) => ({ ...on[name], reach: pair.outline[name].radius_mm.tip })));
    const reachAt = (name, place) => {
      const shaft = this.shafts.get(name);
      const near = discs.filter((disc) => disc.shaft === name && Math.abs(disc.position_mm - place) < shaft.length_mm / 32).map(({ reach }) => reach);
      return Math.max(sectionAt(shaft, place).outer_diameter_mm / 2, ...near);
    };
    this.letHullGo();
    this.motion = motion && new Motion(motion, this.reach, reachAt);
  }

  /** Let its housing stand about it. @param {import("./view_motion.js").Surface | null} surface null: it has none */
  house(surface) {
    this.letHullGo();
    Object.assign(this, { solid: surface, housing: surface && hullOf(surface) });
  }

  /** The housing as it is drawn: that of the motion, or where it stands. */
  get drawnHousing() {
    return this.motion?.hull ?? this.housing;
  }

  begin(gl, programs) {
    Object.assign(this, { gl, programs, hull: null });
    for (const { pair } of this.stages) pair.begin(gl, programs);
    this.embody();
  }

  embody() {
    this.bodies = this.parts.map((part) => ({ ...part, mesh: held(this.gl, part.mesh) }));
  }

  /** Shafts and bearings, each with its mesh about the axis of its shaft. */
  get parts() {
    const shafts = [...this.shafts.values()].map((shaft) => ({ name: shaft.name, shaft, mesh: shaftMesh(shaft), color: COLORS.shaft }));
    const bearings = bearingsOf(this.scene).filter(({ shaft }) => this.shafts.has(shaft));
    const own = bearings.map((bearing) => ({ bearing, shaft: this.shafts.get(bearing.shaft) }));
    return [...shafts, ...own.map(({ bearing, shaft }) => ({ name: bearing.name, shaft, mesh: bearingMesh(bearing, shaft), color: COLORS.bearing }))];
  }

  /** Let go of what it holds. */
  end(gl) {
    freed(gl, this.bodies.map(({ mesh }) => mesh));
    this.bodies = null;
    this.letHullGo();
    for (const { pair } of this.stages) pair.end(gl);
  }

  letHullGo() {
    if (this.hull) freed(this.gl, [this.hull]);
    this.hull = null;
  }

  /** Color a shaft, bearing or gear. @param {string} name of none: all as they are */
  mark(name) {
    this.marked = name;
    for (const { on, pair } of this.stages) pair.colors = mapped(on, (gear) => (gear.name === name ? MARKED : OF_PAIR[gear === on.pinion ? "pinion" : "wheel"]));
  }

  /** The gear or bearing that is marked. */
  get sliding() {
    return [...(this.scene.gears ?? []), ...bearingsOf(this.scene)].find(({ name, shaft }) => name === this.marked && this.shafts.has(shaft));
  }

  get middle() {
    const part = this.slid && this.sliding;
    return part ? this.shafts.get(part.shaft).origin_mm.map((value, k) => value + (k === 2 ? part.position_mm : 0)) : null;
  }

  /** Move the part that is marked, to an end of its shaft at most. @param {number} mm */
  slide(mm) {
    const { shaft, position_mm: position } = this.sliding;
    const place = Math.min(Math.max(position + mm, 0), this.shafts.get(shaft).length_mm);
    this.slid(this.marked, Number(place.toFixed(6)));
  }

  /** Both corners of a box about the axes and the housing. */
  get box() {
    const ends = [...this.shafts.values()].flatMap(({ origin_mm: [x, y, z], length_mm: length }) => [[x, y, z], [x, y, z + length]]);
    const corners = [...ends, ...(this.drawnHousing?.ends ?? [])];
    return [Math.min, Math.max].map((end) => [0, 1, 2].map((k) => (corners.length ? end(...corners.map((corner) => corner[k])) : 0)));
  }

  /** Half of its size in mm. */
  get reach() {
    const [low, high] = this.box;
    const beyond = this.drawnHousing ? [] : this.stages.map(({ pair }) => 0.5 * pair.outline.wheel.radius_mm.tip); // gears are within a housing
    return (Math.hypot(...high.map((value, k) => (value - low[k]) / 2)) + Math.max(0, ...beyond)) || 1;
  }

  frame(camera) {
    const [low, high] = this.box;
    camera.look(/** @type {[number, number, number]} */ (low.map((value, k) => (value + high[k]) / 2)), this.reach, 0.8, 0.35, 0.85);
  }

  advance(seconds) {
    if (this.motion?.oscillates) this.motion.advance(seconds);
    else this.position += SPEED * seconds;
  }

  draw(gl, frame) {
    gl.enable(gl.CULL_FACE);
    if (!frame.picking) this.revolved(gl, frame, this.bodies);
    const marked = [];
    this.stages.forEach(({ pair, place, ratio, on, angle }, k) => {
      const moved = (name) => [name, this.motion.ofDisc(on[name].shaft, on[name].position_mm, middleOf(pair.outline[name]), angle) ?? STILL];
      pair.moved = this.motion && Object.fromEntries(GEARS.map(moved));
      pair.position = ratio * this.position;
      const own = (name) => ({ ...frame, view: product(frame.view, place[name]), code: 8 * k + 1 });
      const gear = (name) => pair.gear(gl, name, frame.picking ? ["PICK"] : ["SMOOTH", "STEEL"], own(name), 1);
      if (frame.picking !== "marked") GEARS.forEach(gear);
      marked.push(() => GEARS.filter((name) => on[name].name === this.marked).forEach(gear));
    });
    if (frame.picking === true) return;
    if (this.drawnHousing && !frame.picking) this.surface(gl, frame);
    gl.clear(gl.DEPTH_BUFFER_BIT); // what is marked is seen through all else
    this.revolved(gl, frame, this.bodies.filter(({ name }) => name === this.marked));
    for (const again of marked) again();
  }

  /** Draw the surface of a housing by its levels; what moves with it, or stands in it, is seen through it. */
  surface(gl, frame) {
    const [{ program, at }, { mesh, parts, levels }] = [this.programs("hull", "LEVELS"), this.drawnHousing];
    const { phase, part, factor } = this.motion ?? { phase: 0, part: 0, factor: 0 };
    this.hull ??= held(gl, mesh, parts);
    gl.useProgram(program);
    gl.uniform1f(at.opacity, !levels ? 0.3 : this.motion.shafts.size ? 0.7 : 1);
    gl.uniformMatrix4fv(at.view, false, frame.view);
    gl.uniform3fv(at.back, frame.back);
    gl.uniform2f(at.now, part * factor * Math.cos(phase), part * factor * Math.sin(phase));
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(Boolean(levels));
    gl.bindVertexArray(this.hull.array);
    if (levels) gl.disable(gl.CULL_FACE); // coarse facets of a thin wall are of either side
    for (const seen of levels ? [false, true] : [true]) { // with levels its nearest walls alone are seen
      gl.colorMask(seen, seen, seen, seen);
      gl.drawElements(gl.TRIANGLES, this.hull.count, gl.UNSIGNED_INT, 0);
    }
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  /** Draw shafts and bearings. */
  revolved(gl, frame, bodies) {
    const { program, at } = this.programs(this.motion ? "moved" : "straight", "STEEL");
    gl.useProgram(program);
    gl.uniform3fv(at.back, frame.back);
    gl.uniform4f(at.center, 0, 0, 0, 0);
    gl.uniform4f(at.bend, 0, 0, 0, 1);
    for (const { name, shaft, mesh, color } of bodies) {
      if (this.motion) put(gl, at, (name === shaft.name && this.motion.ofShaft(name)) || STILL); // bearings stand
      gl.uniformMatrix4fv(at.view, false, product(frame.view, placement(0, shaft.origin_mm)));
      gl.uniform4f(at.turning, (this.turns.get(shaft.name) ?? 0) * this.position, 0, 0, 1);
      gl.uniform4f(at.color, ...(name === this.marked ? MARKED : color), 1);
      gl.bindVertexArray(mesh.array);
      gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_INT, 0);
    }
  }

  /** @param {Uint8Array | null} texel */
  picked(texel) {
    if (texel) this.open(this.stages[Math.floor((texel[0] - 1) / 8)].mesh);
  }
}

/** The unit of a scene, with the outlines of its meshes. @param {any} scene @param {(mesh: any) => void} open @throws {import("./api.js").Problem} a case has faults */
export async function gearboxOf(scene, open) {
  const written = (mesh) => mesh.case ?? (mesh.database_hash ? caseOf(mesh.database_hash) : null);
  const meshes = await Promise.all((scene.meshes ?? []).map(async (mesh) => ({ ...mesh, case: await written(mesh) })));
  const drawn = meshes.filter((mesh) => mesh.case);
  const outlines = await Promise.all(drawn.map((mesh) => patiently(() => ask("outline", { inputs: { case: mesh.case } }))));
  return new Gearbox(scene, drawn.map((mesh, k) => ({ mesh, outline: outlines[k] })), open);
}
