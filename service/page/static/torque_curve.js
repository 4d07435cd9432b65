/** Peak-to-peak transmission error over torque, under the torque slider: where a pair is quiet. */

import { Problem, ask } from "./api.js";
import { withError } from "./digits.js";
import { make, number } from "./elements.js";
import { band } from "./lines.js";
import { layout } from "./live_figures.js";
import { plot } from "./plots.js";

const [LOADS, CLOSER] = [16, 1.5]; // up to the end of the slider; the power by which they are closer at low ones
const PART = 8; // loads of a request, for which a slider that moves again waits: a quarter of a second
const KEPT = 8; // pairs
const THUMB = 8; // half of that of a slider, px: it stands over its torque

/** @typedef {{key: string, flanks: object}} Asked an analyzed pair, and its flanks and misalignment where they differ */
/** @typedef {{torque: number, ripple: number, error: number}[]} Rows */

export class TorqueCurve {
  /** @param {number} highest torque of the slider @param {string} caller @param {() => void} seen called when it comes into sight after it was left out @param {(torque: number) => void} choose takes a torque that is clicked */
  constructor(highest, caller, seen, choose) {
    Object.assign(this, { highest, caller });
    this.loads = Array.from({ length: LOADS }, (_, k) => Number((highest * ((k + 1) / LOADS) ** CLOSER).toPrecision(5)));
    this.loads[LOADS - 1] = highest;
    this.node = make("div", { class: "plot torque-curve", role: "img", "aria-label": "Peak to peak over torque: not computed yet" });
    /** @type {Map<string, {rows: Rows, ended: boolean}>} */
    this.known = new Map();
    /** @type {Record<string, Rows>} */
    this.drawn = {};
    this.sight = new ResizeObserver(() => {
      if (!this.visible || !this.missed) return;
      this.missed = false;
      seen();
    });
    this.sight.observe(this.node);
    this.node.addEventListener("click", ({ offsetX }) => {
      const torque = (highest * (offsetX - THUMB)) / (this.node.clientWidth - 2 * THUMB);
      if (torque > 0) choose(Number(Math.min(torque, highest).toPrecision(2)));
    });
  }

  get visible() {
    return this.node.clientWidth > 0;
  }

  /** @param {Asked} asked */
  of({ key, flanks }) {
    const name = JSON.stringify([key, flanks]);
    const entry = this.known.get(name) ?? { rows: [], ended: false };
    this.known.delete(name);
    this.known.set(name, entry); // what was used last goes last
    if (this.known.size > KEPT) this.known.delete(this.known.keys().next().value);
    return entry;
  }

  /**
   * Ask for what is missing, a few loads at a time, until the hand moves. Teeth that differ would take a minute.
   * @param {any[]} shown
   * @param {() => boolean} moved
   */
  async follow(shown, moved) {
    this.missed = !this.visible;
    for (const { asked, curve } of this.visible ? shown : []) {
      const entry = this.of(asked);
      while (curve.period === 1 && !entry.ended && !moved()) await this.further(entry, asked);
    }
    if (!moved()) await this.draw(shown);
  }

  async further(entry, { key, flanks }) {
    const { rows } = entry;
    const torques = this.loads.slice(rows.length, rows.length + PART);
    try {
      const { curves, cpu_seconds: cpu } = await ask(`${key}/ste`, { ...flanks, torque_n_m: torques, caller: `${this.caller}-torques` });
      rows.push(...curves.map((curve) => (
        { torque: curve.torque_n_m, ripple: curve.peak_to_peak_um, error: curve.peak_to_peak_error_um })));
      this.node.dataset.cpu = Number(this.node.dataset.cpu ?? 0) + cpu;
      entry.ended = rows.length === LOADS;
    } catch (problem) { // a variant that was analyzed at lower loads ends there
      if (!(problem instanceof Problem) || !problem.errors.length) throw problem;
      entry.ended = true;
    }
  }

  /** Draw what is known of the pairs that are shown, the last in front, each with its torque marked. @param {any[]} shown */
  async draw(shown) {
    const pairs = shown.map((each) => this.drawable(each)).filter(({ rows }) => rows.length);
    this.node.classList.toggle("passed", pairs.some(({ ended }) => !ended));
    if (!pairs.length) return;
    const top = Math.max(...pairs.flatMap(({ rows, curve }) => [curve.peak_to_peak_um, ...rows.map(({ ripple, error }) => ripple + (error || 0))]));
    const now = shown.at(-1).curve.torque_n_m;
    const axes = { data: [{ x: [0, this.highest], y: [0, 0], line: { width: 0 } }, { x: [now, now], y: [0, top], line: { color: "#767676", width: 1 } }] };
    const made = layout("", "peak to peak, µm", { margin: { l: THUMB, r: THUMB, t: 22, b: 20 } });
    made.yaxis.side = "right";
    this.words(pairs);
    await plot(this.node, { data: [...axes.data, ...pairs.flatMap((pair) => this.traces(pair))], layout: made, still: true });
  }

  /** A pair with its rows, those drawn last while its own are under way. */
  drawable(pair) {
    const { rows, ended } = this.of(pair.asked);
    if (ended) this.drawn[pair.name] = rows;
    return { ...pair, ended, rows: this.drawn[pair.name] ?? [] };
  }

  traces({ rows, curve, color, width, dash, name }) {
    const x = rows.map(({ torque }) => torque);
    const [low, high] = [-1, 1].map((side) => rows.map(({ ripple, error }) => Math.max(0, ripple + side * (error || 0))));
    return [
      band(x, low, high, color),
      { x, y: rows.map(({ ripple }) => ripple), name, line: { color, width: width - 0.4, dash } },
      { x: [curve.torque_n_m], y: [curve.peak_to_peak_um], mode: "markers", marker: { color } },
    ];
  }

  words(pairs) {
    const said = pairs.map(({ name, rows }) => {
      const least = rows.reduce((one, other) => (other.ripple < one.ripple ? other : one));
      return `${name} least ${withError(least.ripple, least.error, "µm")} at ${number(least.torque, 3)} N m, ${withError(rows.at(-1).ripple, rows.at(-1).error, "µm")} at ${number(rows.at(-1).torque, 3)} N m`;
    });
    this.node.setAttribute("aria-label", `Peak to peak over torque: ${said.join("; ")}.`);
  }
}
