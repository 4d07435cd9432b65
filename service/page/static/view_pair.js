// @ts-check
/** The pair as it rolls: teeth from the outline, pressure and bending from the live answer. */

import { number } from "./elements.js";
import { flankMap } from "./view_flank.js";
import { freed, held, program, tables } from "./view_gl.js";
import { BENT as BENDING, FLANK, HULL, LEVELS, MOVED, PICK, STEEL, TOOTH } from "./view_shaders.js";
import { toothMesh } from "./view_teeth.js";

const SPEED = 0.4; // base pitches a second
export const COLORS = { pinion: [0.60, 0.64, 0.69], wheel: [0.79, 0.80, 0.80] }; // two steels: blue and orange are designs
const NEAR = 0.2; // opacity of the side of the wheel that is seen through
const FAR = 0.5; // and of the side behind it
export const GEARS = ["pinion", "wheel"];
const LINE = 0.05; // half width of a contact line as drawn, base pitches
const STEPS = [1, 1.2, 1.6, 2, 2.5, 3, 4, 5, 7.5, 10]; // of the ends of a scale

/** @typedef {{first_place: number, step: number, face_position_mm: number[], pressure_mpa: number[][], apart_um: number[][]}} Passage */
/** @typedef {{position: number[], period: number, pair: number[], load_share: number[][], normal_force_n: number, passage: Passage}} Curve */

const radians = (degrees) => (degrees * Math.PI) / 180;
export const most = (rows) => rows.reduce((top, row) => Math.max(top, ...row), 0);

/** The end of a scale that holds a value. @param {number} value */
function scaleOf(value) {
  const size = 10 ** Math.floor(Math.log10(value || 1));
  return size * (STEPS.find((step) => step * size >= value) ?? 10);
}

const TEETH = { straight: TOOTH, bent: BENDING + TOOTH, moved: MOVED + TOOTH, hull: HULL };
const PARTS = { STEEL, FLANK, PICK, LEVELS };

/** By how teeth stand and what is drawn of them; each is made when it draws for the first time. @param {WebGL2RenderingContext} gl */
export function programsOf(gl) {
  const made = {};
  return (teeth, part) => (made[`${teeth} ${part}`] ??= program(gl, TEETH[teeth], PARTS[part]));
}

/** Let a program move what it draws. @param {WebGL2RenderingContext} gl @param {import("./view_motion.js").Moved} moved */
export function put(gl, at, { values, stations }) {
  gl.uniform3fv(at["moved[0]"], values);
  gl.uniform3f(at.stations, ...stations);
}

/** The rolling pair, drawn by a stage. @implements {import("./view_stage.js").Subject} */
export class RollingPair {
  constructor() {
    this.outline = null;
    /** @type {Curve | null} */
    this.curve = null;
    this.position = 0;
    this.top = 0;
    this.bent = 0;
    this.through = true;
    this.meshes = {};
    this.colors = COLORS;
    /** @type {Record<string, import("./view_motion.js").Moved> | null} how its gears move as discs */
    this.moved = null;
    this.told = (/** @type {string} */ _words, /** @type {HTMLElement | undefined} */ _map) => {};
  }

  /** @param {WebGL2RenderingContext} gl */
  begin(gl, programs) {
    this.programs = programs;
    this.texture = gl.createTexture();
    this.meshes = {};
    this.press(gl, this.curve);
  }

  /** Let go of what it holds. @param {WebGL2RenderingContext} gl */
  end(gl) {
    this.show(gl, this.outline);
    gl.deleteTexture(this.texture);
    this.texture = null;
  }

  /** @param {any} outline answer of /v1/cases/outline */
  show(gl, outline) {
    this.outline = outline;
    freed(gl, Object.values(this.meshes));
    this.meshes = {};
  }

  /** @param {WebGL2RenderingContext} gl @param {Curve | null} curve */
  press(gl, curve) {
    this.curve = curve;
    const passage = curve?.passage;
    if (this.texture) tables(gl, this.texture, passage?.pressure_mpa ?? [[0]], passage?.apart_um ?? [[0]]);
    if (passage) this.top = Math.max(this.top, scaleOf(most(passage.pressure_mpa)));
  }

  /** @param {import("./view_camera.js").Camera} camera */
  frame(camera) {
    if (!this.outline) return;
    const gears = GEARS.map((name) => this.outline[name]);
    const outer = ({ radius_mm: { tip, held } }) => Math.max(tip, held);
    const [left, right] = [1, -1].map((side) => side * Math.max(...gears.map((gear) => side * gear.centre_mm[1] + outer(gear))));
    const [low, high] = [Math.min(...gears.map(({ face_mm: ends }) => ends[0])), Math.max(...gears.map(({ face_mm: ends }) => ends[1]))];
    const radius = Math.max(Math.max(...gears.map(outer)), 0.7 * (high - low));
    const reach = Math.max(radius, 0.5 * (left - right));
    camera.look([gears[1].centre_mm[0] / 2, 0.5 * (left + right), 0.5 * (low + high)], radius, 0.75, -0.3, 0.9, { reach, lying: true });
  }

  advance(seconds) {
    if (!this.outline) return;
    const period = this.outline.pinion.teeth * this.outline.wheel.teeth;
    this.position = (this.position + SPEED * seconds) % period;
  }

  draw(gl, frame) {
    if (!this.outline) return;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.enable(gl.CULL_FACE);
    if (frame.picking) {
      for (const name of this.through ? ["pinion"] : GEARS) this.gear(gl, name, ["PICK"], frame, 1); // what is seen through is clicked through
      return;
    }
    const flank = this.curve ? "FLANK" : "SMOOTH";
    this.gear(gl, "pinion", ["STEEL"], frame, 1);
    if (this.through) {
      this.layer(gl, frame, "SMOOTH", FAR);
      this.layer(gl, frame, flank, NEAR);
    } else this.gear(gl, "wheel", [flank, "STEEL"], frame, 1);
    this.gear(gl, "pinion", [flank], frame, 1); // last: not behind what is seen through
  }

  /** Draw the wheel as it is seen through: its far side, or its near one; of either what is in front. */
  layer(gl, frame, flank, opacity) {
    gl.cullFace(opacity === FAR ? gl.FRONT : gl.BACK);
    this.depth(gl, "wheel", [flank, "STEEL"], frame);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.enable(gl.STENCIL_TEST); // a pixel once: where teeth overlap both would pass the depth that they have in common
    gl.clear(gl.STENCIL_BUFFER_BIT);
    gl.stencilFunc(gl.EQUAL, 0, 1);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    this.gear(gl, "wheel", [flank, "STEEL"], frame, opacity);
    gl.disable(gl.STENCIL_TEST);
    gl.disable(gl.BLEND);
    gl.cullFace(gl.BACK);
    gl.clear(gl.DEPTH_BUFFER_BIT); // the depth of the pinion alone hides what comes after
    this.depth(gl, "pinion", ["STEEL"], frame);
  }

  /** Draw the depth of a gear alone. */
  depth(gl, name, parts, frame) {
    gl.colorMask(false, false, false, false);
    this.gear(gl, name, parts, frame, 1);
    gl.colorMask(true, true, true, true);
  }

  /** A tooth of a gear, coarse where it moves. */
  mesh(gl, name, moving) {
    return (this.meshes[`${name} ${moving}`] ??= held(gl, toothMesh(this.outline[name], this.outline.internal && name === "wheel", moving)));
  }

  /** Parts of a gear: FLANK or SMOOTH, its flanks that carry; STEEL, all else; PICK, both. */
  gear(gl, name, parts, { view, back, moving, code = 1 }, opacity) {
    const stands = this.moved ? "moved" : this.bent && this.curve ? "bent" : "straight";
    const { teeth } = this.outline[name];
    const { array, count, marked } = this.mesh(gl, name, moving);
    const rest = count - marked;
    const ranges = { FLANK: [rest, marked], SMOOTH: [rest, marked], STEEL: [0, rest], PICK: [0, count] };
    gl.bindVertexArray(array);
    for (const part of parts) {
      const { program: used, at } = this.programs(stands, part === "SMOOTH" ? "STEEL" : part);
      const [from, length] = ranges[part];
      gl.useProgram(used);
      gl.uniformMatrix4fv(at.view, false, view);
      gl.uniform3fv(at.back, back);
      gl.uniform1f(at.gear, code + GEARS.indexOf(name));
      gl.uniform4f(at.color, ...this.colors[name], opacity);
      this.place(gl, at, name);
      gl.drawElementsInstanced(gl.TRIANGLES, length, gl.UNSIGNED_INT, 4 * from, teeth);
    }
    gl.bindVertexArray(null);
  }

  /** Where the teeth of a gear stand, and where and how much they are loaded. */
  place(gl, at, name) {
    const gear = this.outline[name];
    const [contact, passage] = [this.contact(name), this.curve?.passage];
    const { root, base } = gear.radius_mm;
    const bent = this.bent * 1e-3 * gear.turn;
    gl.uniform4f(at.turning, radians(gear.angle_deg), (gear.turn * 2 * Math.PI) / gear.teeth, this.position, gear.teeth);
    gl.uniform4f(at.center, ...gear.centre_mm, 0.5 * (gear.face_mm[0] + gear.face_mm[1]), radians(gear.twist_deg_per_mm));
    gl.uniform4f(at.contact, contact.pitch, contact.sense, contact.basePitch, contact.rise);
    gl.uniform4f(at.bend, name === "pinion" ? -bent : bent, name === "pinion" ? 0 : (-bent * this.apart) / base, root, base);
    gl.uniform4f(at.table, passage?.first_place ?? 0, passage?.step ?? 1, ...this.face);
    gl.uniform2f(at.shown, this.top, LINE * contact.basePitch);
    gl.uniform2f(at.ends, ...contact.ends);
    gl.uniform2f(at.face, ...gear.face_mm);
    if (this.moved) put(gl, at, this.moved[name]);
  }

  /** Where the flank of a gear is touched: roll lengths in mm at the pitch point and the ends of the path. */
  contact(name) {
    const { pinion, internal, path_of_contact: { points_mm: points, base_pitch_mm: basePitch } } = this.outline;
    const gear = this.outline[name];
    const roll = ([x, y]) => Math.sqrt(Math.max(0, Math.hypot(x - gear.centre_mm[0], y - gear.centre_mm[1]) ** 2 - gear.radius_mm.base ** 2));
    const rise = pinion.radius_mm.base * radians(pinion.twist_deg_per_mm);
    const ends = [roll(points.A), roll(points.E)].sort((a, b) => a - b);
    return { pitch: roll(points.C), sense: name === "pinion" || internal ? 1 : -1, basePitch, rise, ends };
  }

  /** How far apart the loaded flanks are moved now, in um: the mean by pressure over what carries. */
  get apart() {
    if (!this.curve) return 0;
    const { first_place: first, step, pressure_mpa: pressure, apart_um: apart } = this.curve.passage;
    let [weight, sum] = [0, 0];
    const turn = this.position - Math.floor(this.position);
    for (let row = (((turn - first) / step) % (1 / step)); row < pressure.length; row += 1 / step) {
      const k = Math.min(Math.max(Math.round(row), 0), pressure.length - 1);
      pressure[k].forEach((value, i) => {
        weight += value;
        sum += value * apart[k][i];
      });
    }
    return weight ? sum / weight : 0;
  }

  /** @param {Uint8Array | null} texel */
  picked(texel) {
    this.told(...(texel ? this.flank(texel) : [""]));
  }

  /** Both ends of the face over which pressure is known: of a plane model, where the faces meet. */
  get face() {
    const { pinion, wheel } = this.outline;
    const known = this.curve?.passage.face_position_mm ?? [];
    const common = [Math.max(pinion.face_mm[0], wheel.face_mm[0]), Math.min(pinion.face_mm[1], wheel.face_mm[1])];
    return known.length > 1 ? [known[0], known[known.length - 1]] : common;
  }

  /** What stands at a picked place, in words and as a map: tooth, place on its flank, pressure, share of the load. */
  flank([code, low, along, across]) {
    const name = GEARS[((code % 8) - 1) % 2];
    const gear = this.outline[name];
    const tooth = low + 256 * Math.floor(code / 8);
    const words = `${name}, tooth ${tooth + 1}`;
    if (code % 8 < 3) return [`${words}: not on the flank that carries.`];
    const { ends, pitch, sense, basePitch, rise } = this.contact(name);
    const roll = (part) => ends[0] + (ends[1] - ends[0]) * part;
    const z = (part) => gear.face_mm[0] + (gear.face_mm[1] - gear.face_mm[0]) * part;
    const pressure = (x, y) => this.pressure((sense * (roll(y) - pitch) + z(x) * rise) / basePitch, z(x));
    const [x, y] = [across / 255, along / 255];
    const at = `${words}: roll length ${number(roll(y), 3)} mm, face ${number(z(x), 3)} mm`;
    if (!this.curve) return [`${at}.`];
    const pair = ((this.position + tooth + gear.teeth / 2) % gear.teeth) - gear.teeth / 2;
    const map = flankMap({ pressure, top: this.top, across: x, up: y, words: `Pressure over the flank of the ${name}, tip above` });
    return [`${at}: ${number(pressure(x, y), 3)} MPa as the contact passes. ${this.share(pair)}`, map];
  }

  /** @param {number} place of a pair @param {number} z */
  pressure(place, z) {
    const { first_place: first, step, pressure_mpa: rows } = this.curve.passage;
    const row = rows[Math.round((place - first) / step)];
    const [low, high] = this.face;
    const column = ((z - low) / (high - low)) * ((row?.length ?? 1) - 1);
    const within = row?.length === 1 ? z >= low && z <= high : column > -0.5 && column < (row?.length ?? 0) - 0.5;
    return row && within ? row[Math.round(column)] : 0;
  }

  /** What the pair of a tooth carries now. @param {number} place */
  share(place) {
    const { position, pair, load_share: shares, normal_force_n: force } = this.curve;
    const turn = place - Math.floor(place);
    const row = position.reduce((best, value, k) => (Math.abs(value - turn) < Math.abs(position[best] - turn) ? k : best), 0);
    const share = shares[row][pair.indexOf(Math.floor(place))] ?? 0;
    return share > 1e-4 ? `This tooth pair carries ${number(100 * share, 2)} % of the load at this position, ${number(share * force, 3)} N.` : "This tooth pair carries no load at this position.";
  }
}
