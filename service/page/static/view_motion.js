// @ts-check
/** A motion of a unit by a result: how shafts move at a phase, and the choice of it under the picture. */

import { get, patiently, saidIn } from "./api.js";
import { make, number } from "./elements.js";

export const STATIONS = 33; // along a shaft
const SHARE = 0.08; // of the size of the unit that the largest motion is drawn with
export const MOVING = new Set(["modes", "deflection"]); // kinds of results that have motions

/** @typedef {{name: string, position_mm: number[], real: number[][], imaginary: number[][]}} ShaftMotion six at each station: mm and rad */
/** @typedef {{oscillates: boolean, shafts: ShaftMotion[]}} UnitMotion */
/** @typedef {{values: Float32Array, stations: number[]}} Moved displacement and rotation of each station; first place, distance, whether it is all one disc */

/** @param {number[][]} rows */
const whole = (rows) => rows.length === STATIONS && rows.every((row) => row.length === 6 && row.every(Number.isFinite));

export class Motion {
  /** @param {UnitMotion} motion @param {number} size of the unit in mm @param {(shaft: string, place: number) => number} reachAt how far out something is at a place of a shaft, mm */
  constructor({ oscillates, shafts }, size, reachAt) {
    if (!shafts.every(({ real, imaginary }) => whole(real) && whole(imaginary))) throw new TypeError("The motion has other stations than the page draws.");
    this.oscillates = oscillates;
    this.shafts = new Map(shafts.map((shaft) => [shaft.name, shaft]));
    this.phase = 0;
    this.part = 1;
    const sizes = shafts.flatMap(({ name, position_mm: [low, high], real, imaginary }) => real.map((row, k) => {
      const amplitude = row.map((value, i) => Math.hypot(value, imaginary[k][i]));
      return Math.hypot(...amplitude.slice(0, 3)) + reachAt(name, low + ((high - low) * k) / (STATIONS - 1)) * Math.hypot(...amplitude.slice(3));
    }));
    this.factor = (SHARE * size) / Math.max(...sizes, Number.MIN_VALUE);
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
    this.list = make("select", { "aria-label": "Motion", "data-unkept": true, onchange: () => this.choose() });
    this.amplitude = make("input", { type: "range", min: "0", max: "3", step: "0.1", value: "1", "aria-label": "Amplitude", "data-unkept": true, oninput: () => this.scale() });
    this.factor = make("output", {});
    this.block = make("span", { class: "view-controls", hidden: true }, this.list, this.amplitude, this.factor);
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
    signal.addEventListener("abort", () => {
      if (this.href !== href) return;
      this.block.hidden = true;
      if (this.list.value) this.rest();
    });
  }

  choose() {
    if (!this.list.value) return this.rest();
    const { value } = this.list;
    return saidIn(this.view.words, async () => {
      const { motion } = await get(`${this.href}/motion?number=${value}`);
      if (this.list.value !== value) return;
      if (this.view.wanted?.scene !== this.scene) this.before = this.view.wanted;
      await this.view.see(this.scene);
      this.view.gearbox.move(motion);
      this.view.words.textContent = this.list.selectedOptions[0].textContent;
      this.scale();
    });
  }

  /** Show again what was shown before. */
  rest() {
    this.list.value = "";
    this.factor.textContent = "";
    this.view.gearbox?.move(null);
    const { scene = null, part, open } = this.before ?? {};
    return this.view.see(scene, part, open);
  }

  /** Another thing is shown. @param {any} scene */
  seen(scene) {
    if (scene !== this.scene) this.list.value = "";
  }

  scale() {
    const motion = this.view.gearbox?.motion;
    if (!motion) return;
    motion.part = Number(this.amplitude.value);
    this.factor.textContent = motion.oscillates ? "" : `× ${number(motion.part * motion.factor, 2)}`;
    this.view.stage.wake();
  }
}
