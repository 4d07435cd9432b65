/** What pairs within a tolerance class have, as a band behind the ripple; drawn at the service when the sliders rest. */

import { Problem, ask } from "./api.js";
import { withError } from "./digits.js";
import { make } from "./elements.js";
import { band } from "./lines.js";
import { over } from "./live_figures.js";

const USUAL = 6; // where a case states no class
const KEPT = 8; // bands

/** A switch, a class, and the figures in words. */
export class MadeBand {
  /** @param {any} content the case, which may state a class @param {string} caller @param {() => void} changed */
  constructor(content, caller, changed) {
    this.stated = content?.errors?.misalignment_class;
    this.caller = caller;
    /** @type {Map<string, any>} */
    this.known = new Map();
    this.on = make("input", { type: "checkbox", id: "band-on", onchange: changed });
    this.class = make("input", {
      type: "number", id: "band-class", min: 1, max: 11, step: 1, value: this.stated ?? USUAL, "aria-label": "Tolerance class of ISO 1328-1:2013", onchange: changed,
    });
    this.words = make("output", { for: "band-on band-class" });
    this.node = make("div", { class: "made-band" }, make("label", {}, this.on, " as made, class"), this.class, this.words);
  }

  /** @param {any} pair */
  of({ asked: { key, flanks }, curve }) {
    const question = { ...flanks, torque_n_m: [curve.torque_n_m], tolerance_class: Number(this.class.value) };
    return { key, question, name: JSON.stringify([key, question]) };
  }

  /** The pairs that have a band, if it is wanted: not what was analyzed, which is there to compare with. @param {any[]} shown */
  wanted(shown) {
    return this.on.checked && this.node.clientWidth ? shown.slice(1).reverse() : [];
  }

  /** Ask until every band is there or the hand moves. @param {any[]} shown @param {() => boolean} moved */
  async follow(shown, moved) {
    for (const pair of this.wanted(shown)) {
      const { key, question, name } = this.of(pair);
      while (!this.known.has(name) && !moved()) await this.further(key, question, name);
    }
  }

  async further(key, question, name) {
    let found;
    try {
      const { curves } = await ask(`${key}/ste`, { ...question, preview: true, caller: `${this.caller}-made` });
      found = curves[0].band;
      if (found.solved < found.of) return;
    } catch (problem) { // teeth that differ, a gear beyond the standard: it says so
      if (!(problem instanceof Problem) || !problem.errors.length) throw problem;
      found = { refused: problem.message };
    }
    this.known.set(name, found);
    if (this.known.size > KEPT) this.known.delete(this.known.keys().next().value);
  }

  /** Bands of what is shown, as traces; their figures stand in words. @param {any[]} shown */
  traces(shown) {
    const bands = this.wanted(shown).map((pair) => ({ ...pair, band: this.known.get(this.of(pair).name) ?? { refused: `${pair.name}: pairs are drawn.` } }));
    this.words.textContent = bands.map(({ name, band: of }) => of.refused ?? this.said(name, of)).join(" ");
    return bands.filter(({ band: of }) => of.position).map(({ band: of, color }) => {
      const [low, high] = [of.low_um, of.high_um].map((values) => over({ period: 1, position: of.position }, values));
      return band(low.x, low.y, high.y, color);
    });
  }

  said(name, { tolerance_class: chosen, pairs, of, peak_to_peak: ripple, first_harmonic: tone }) {
    const ends = ({ low_um: low, high_um: high, error_um: error }) => `${withError(low, error)} to ${withError(high, error, "µm")}`;
    const why = chosen === this.stated ? ", that of the case," : !this.stated && chosen === USUAL ? ", as the case states none," : "";
    return `${name}: nine of ten pairs within class ${chosen}${why} have ${ends(ripple)} peak to peak, ${ends(tone)} in the first `
      + `harmonic; ${pairs} drawn, ${of} of them solved.`;
  }
}
