// @ts-check
/** A motion of a unit by a result: how shafts move at a phase, and the choice of it under the picture. */

import { get, patiently, saidIn } from "./api.js";
import { make, number } from "./elements.js";
import { bytesOf } from "./packed.js";
import { isHoused } from "./view_housing.js";

export const STATIONS = 33; // along a shaft
const AT_REST = ". The housing is drawn at rest.";
const RANGE = 30; // dB of the scale of levels
const SHARE = 0.08; // of the size of the unit that the largest motion is drawn with
export const MOVING = new Set(["modes", "deflection", "vibration"]); // kinds of results that have motions

/** @typedef {{name: string, position_mm: number[], real: number[][], imaginary: number[][]}} ShaftMotion six at each station: mm and rad */
/** @typedef {{place_mm: string, normal: string, facets: string}} Surface */
/** @typedef {Surface & {real: string, imaginary: string, level_db: string | null, level_re: string}} SurfaceMotion */
/** @typedef {{oscillates: boolean, shafts: ShaftMotion[], surface: SurfaceMotion | null}} UnitMotion */
/** @typedef {{values: Float32Array, stations: number[]}} Moved displacement and rotation of each station; first place, distance, whether it is all one disc */

/** @param {number[][]} rows */
const whole = (rows) => rows.length === STATIONS && rows.every((row) => row.length === 6 && row.every(Number.isFinite));

/** A surface as it is drawn, and the ends of its scale. @param {Surface & Partial<SurfaceMotion>} surface without a motion: it stands */
export function hullOf(surface) {
  const floats = (text) => new Float32Array(bytesOf(text).buffer);
  const [place, normal] = [surface.place_mm, surface.normal].map(floats);
  const [real, imaginary] = [surface.real, surface.imaginary].map((part) => (part === undefined ? new Float32Array(place.length) : floats(part)));
  const levels = surface.level_db && floats(surface.level_db);
  const indices = new Uint32Array(bytesOf(surface.facets).buffer);
  const count = place.length / 3;
  const fits = [normal, real, imaginary].every(({ length }) => length === 3 * count) && (!levels || levels.length === count);
  if (!fits || ![place, normal, real, imaginary, levels ?? []].every((values) => values.every(Number.isFinite)) || indices.some((node) => node >= count)) {
    throw new TypeError("The surface has other nodes than its motion.");
  }
  const top = levels ? Math.ceil(levels.reduce((most, level) => Math.max(most, level), -Infinity)) : 0;
  const values = new Float32Array(13 * count);
  const ends = [Infinity, -Infinity].map((value) => [value, value, value]);
  let most = 0;
  for (let k = 0; k < count; k += 1) {
    const three = (array) => array.subarray(3 * k, 3 * k + 3);
    values.set([...three(place), ...three(normal), levels ? Math.max(1 - (top - levels[k]) / RANGE, 0) : -1, ...three(real), ...three(imaginary)], 13 * k);
    three(place).forEach((value, i) => {
      ends[0][i] = Math.min(ends[0][i], value);
      ends[1][i] = Math.max(ends[1][i], value);
    });
    most = Math.max(most, Math.hypot(...three(real), ...three(imaginary)));
  }
  return { mesh: { values, indices, marked: 0 }, parts: [3, 3, 1, 3, 3], most, ends, levels: levels ? `surface velocity ${top - RANGE} to ${top} dB re ${surface.level_re}` : null };
}

export class Motion {
  /** @param {UnitMotion} motion @param {number} size of the unit in mm @param {(shaft: string, place: number) => number} reachAt how far out something is at a place of a shaft, mm */
  constructor({ oscillates, shafts, surface }, size, reachAt) {
    if (!shafts.every(({ real, imaginary }) => whole(real) && whole(imaginary))) throw new TypeError("The motion has other stations than the page draws.");
    this.oscillates = oscillates;
    this.shafts = new Map(shafts.map((shaft) => [shaft.name, shaft]));
    this.phase = 0;
    this.part = 1;
    const sizes = shafts.flatMap(({ name, position_mm: [low, high], real, imaginary }) => real.map((row, k) => {
      const amplitude = row.map((value, i) => Math.hypot(value, imaginary[k][i]));
      return Math.hypot(...amplitude.slice(0, 3)) + reachAt(name, low + ((high - low) * k) / (STATIONS - 1)) * Math.hypot(...amplitude.slice(3));
    }));
    this.hull = surface && hullOf(surface);
    this.factor = (SHARE * size) / Math.max(...sizes, this.hull?.most ?? 0, 1e-30);
  }

  advance(seconds) {
    this.phase = (this.phase + Math.PI * seconds) % (2 * Math.PI);
  }

  /** What a row of a shaft is at the phase, turned about z by an angle. @param {ShaftMotion} shaft @param {number} k */
  row({ real, imaginary }, k, angle) {
    const [scale, sine, cosine] = [this.part * this.factor, Math.sin(this.phase), Math.cos(this.phase)];
    const now = real[k].map((value, i) => scale * (value * cosine - imaginary[k][i] * sine));
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return [0, 3].flatMap((i) => [c * now[i] + s * now[i + 1], c * now[i + 1] - s * now[i], now[i + 2]]);
  }

  /** How a shaft moves. @param {string} name @returns {Moved | null} */
  ofShaft(name) {
    const shaft = this.shafts.get(name);
    if (!shaft) return null;
    const [low, high] = shaft.position_mm;
    return { values: new Float32Array(shaft.real.flatMap((_, k) => this.row(shaft, k, 0))), stations: [low, (high - low) / (STATIONS - 1), 0] };
  }

  /** How a disc on a shaft moves as one. @param {string} name @param {number} place on the shaft @param {number} middle where the disc has it in its own z @param {number} angle of its own x @returns {Moved | null} */
  ofDisc(name, place, middle, angle) {
    const shaft = this.shafts.get(name);
    if (!shaft) return null;
    const [low, high] = shaft.position_mm;
    const part = Math.min(Math.max(((place - low) / (high - low)) * (STATIONS - 1), 0), STATIONS - 1);
    const [k, next] = [Math.floor(part), Math.ceil(part)];
    const [before, after] = [this.row(shaft, k, angle), this.row(shaft, next, angle)];
    const values = before.map((value, i) => value + (part - k) * (after[i] - value));
    return { values: new Float32Array([...values, ...values]), stations: [middle, 1e9, 1] };
  }
}

/** The choice among the motions of the result that was shown last. */
export class Motions {
  /** @param {import("./view.js").View} view */
  constructor(view) {
    this.view = view;
    this.list = make("select", { "aria-label": "Motion", "data-unkept": true, onchange: () => this.chosen() });
    this.amplitude = make("input", { type: "range", min: "0", max: "3", step: "0.1", value: "1", "aria-label": "Amplitude", "data-unkept": true, oninput: () => this.scale() });
    this.factor = make("output", {});
    this.levels = make("span", { class: "view-scale", hidden: true });
    this.block = make("span", { class: "view-controls", hidden: true }, this.list, this.amplitude, this.factor, this.levels);
  }

  /**
   * Offer the motions of a result in the picture of its scene.
   * @param {any} scene @param {{href: string}} result @param {AbortSignal} signal given up when the result is left
   */
  async offer(scene, { href }, signal) {
    const { groups } = await patiently(() => get(`${href}/motion`));
    if (signal.aborted) return;
    Object.assign(this, { scene, href });
    let count = 0;
    const options = groups.map(({ name, motions }) => make("optgroup", { label: name }, ...motions.map((words) => make("option", { value: String(count++) }, words))));
    this.list.replaceChildren(make("option", { value: "" }, "at rest, no motion"), ...options);
    this.block.hidden = false;
    this.list.value = this.view.motion ?? "";
    if (this.list.value) this.choose();
    else if (this.view.motion) {
      this.view.words.textContent = `Motion ${this.view.motion} of the address: the result has ${count}, from 0.`;
      this.unsaid();
    }
    signal.addEventListener("abort", () => {
      if (this.href !== href) return;
      this.block.hidden = true;
      if (this.list.value) this.rest();
    });
  }

  /** The address says it. */
  chosen() {
    this.view.motion = this.list.value || null;
    document.dispatchEvent(new Event("typed"));
    return this.choose();
  }

  choose() {
    if (!this.list.value) return this.rest();
    const { value } = this.list;
    return saidIn(this.view.words, async () => {
      const { motion } = await get(`${this.href}/motion?number=${value}`);
      if (this.list.value !== value) return;
      await this.view.present({ scene: this.scene });
      try {
        this.view.gearbox.move(motion);
      } catch (fault) { // what a damaged answer holds
        this.view.words.textContent = `The motion cannot be drawn: ${fault.message}`;
        return;
      }
      if (motion.surface) this.view.stage.frame(true);
      this.view.words.textContent = this.list.selectedOptions[0].textContent + (isHoused(this.scene) && !motion.surface ? AT_REST : "");
      this.scale();
    });
  }

  /** Show again what was shown before. */
  rest() {
    this.list.value = "";
    this.factor.textContent = "";
    this.levels.hidden = true;
    this.view.gearbox?.move(null);
    return this.view.present(this.view.base);
  }

  /** Another thing is looked at. */
  leave() {
    if (!this.list.value) return;
    this.rest();
    this.unsaid();
  }

  /** The address says none. */
  unsaid() {
    this.view.motion = null;
    document.dispatchEvent(new Event("typed"));
  }

  scale() {
    const motion = this.view.gearbox?.motion;
    if (!motion) return;
    motion.part = Number(this.amplitude.value);
    this.factor.textContent = motion.oscillates ? "" : `× ${number(motion.part * motion.factor, 2)}`;
    Object.assign(this.levels, { hidden: !motion.hull?.levels, textContent: motion.hull?.levels ?? "" });
    this.view.stage.wake();
  }
}
