// @ts-check
/** Variants of a design, A to C: each a copy of the fields or a result, all in the address; their curves stand side by side. */

import { HASH, JOB } from "./address.js";
import { Problem, ask } from "./api.js";
import { button, byId } from "./elements.js";
import { caseOf } from "./orders.js";
import { pack, unpack } from "./packed.js";

const LETTERS = ["a", "b", "c"];
const FIRST = "first"; // the first example with the result that came with the program
const KEPT = 8; // curves of another result
export const UNMOVED = { misalignment_um: 0, pinion: {}, wheel: {} };

/** @typedef {{key: string, case: any}} Known an analyzed pair */
/** @typedef {{torque_n_m?: number, misalignment_um: number, pinion: object, wheel: object}} Moved where sliders stand */

/** A result that is not on the sliders, with flanks of its own: its curves at torques that are looked at. */
export class Other {
  /** @param {string} name @param {Known} known @param {Moved} moved */
  constructor(name, known, moved) {
    Object.assign(this, { name, known });
    this.flanks = { ...moved, torque_n_m: undefined };
    /** @type {Map<number, any>} */
    this.curves = new Map();
  }

  /** Its curve; null if it has none at that torque. @param {number} torque @param {string} caller */
  async at(torque, caller) {
    if (this.curves.has(torque)) return this.curves.get(torque);
    try {
      const body = { ...this.flanks, torque_n_m: [torque], flanks: true, caller: `${caller}-${this.name}` };
      const [curve] = (await ask(`${this.known.key}/ste`, body)).curves;
      if (this.curves.size >= KEPT) this.curves.clear();
      this.curves.set(torque, curve);
      return curve;
    } catch (problem) {
      if (!(problem instanceof Problem) || problem.status === 0 || problem.retryAfter) throw problem;
      return null;
    }
  }
}

export class Variants {
  /**
   * @param {{address: import("./address.js").Address, design: import("./design.js").Design, results: import("./results.js").Results}} page
   * @param {() => Promise<void>} render shows what the address says
   */
  constructor(page, render) {
    const { address, design } = page;
    Object.assign(this, { page, address, design, render });
  }

  get on() {
    return this.address.views.get("on") ?? LETTERS[0];
  }

  /** What the variant that is shown is called in an address: its design as typed, its job, or its result. */
  get word() {
    const { names, views, empty } = this.address;
    if (empty) return FIRST;
    const parts = ["database", "live", "case"].map((name) => names.get(name) ?? views.get(name));
    if (parts[0] && parts[2] && this.stands) return parts.map((part) => part ?? "").join(".");
    const result = parts.slice(0, 2).filter(Boolean).join(".");
    return names.get("analyze") ?? views.get("case") ?? (names.has("database") ? result : pack(this.design.case));
  }

  /** Whether what was typed since the result was computed changes nothing of it. */
  get stands() {
    const { content } = this.page.results.note;
    return Boolean(content) && !this.design.edits(content).length;
  }

  /** Offer the variants of this address. */
  offer() {
    const known = LETTERS.filter((letter) => letter === this.on || this.address.views.has(letter));
    const next = LETTERS.find((letter) => !known.includes(letter));
    const variant = (letter) => button(letter.toUpperCase(), () => this.choose(letter), {
      "aria-pressed": String(letter === this.on), "aria-label": `Variant ${letter.toUpperCase()}`,
    });
    const add = next && button("+", () => this.add(next), { "aria-label": "Another variant: a copy of this one" });
    byId("variants").replaceChildren(...known.map(variant), add ?? "");
  }

  /** Begin another variant with what is shown. @param {string} letter */
  async add(letter) {
    this.address.turn(Object.fromEntries(this.address.names), { [this.on]: this.word, on: letter });
    await this.render();
    byId("variants").querySelector("[aria-pressed=true]").focus();
  }

  /** Show another variant. @param {string} letter */
  async choose(letter) {
    if (letter === this.on) return;
    const [word, live, typed] = this.address.views.get(letter).split(".");
    const of = HASH.test(word) ? { database: word } : JOB.test(word) ? { analyze: word } : {};
    const views = { [this.on]: this.word, [letter]: null, on: letter, live: live || null, case: typed ?? (Object.keys(of).length || word === FIRST ? null : word) };
    this.address.turn(of, views, {});
    await this.render();
    byId("variants").querySelector("[aria-pressed=true]").focus();
  }

  /** The results of the other variants, to draw beside this one. @returns {Promise<Other[]>} */
  async others() {
    const words = LETTERS.filter((letter) => letter !== this.on).map((name) => [name, ...(this.address.views.get(name) ?? "").split(".")]);
    const results = words.filter(([, key]) => HASH.test(key));
    return Promise.all(results.map(async ([name, key, live]) => (
      new Other(name, { key, case: await caseOf(key) }, unpack(live ?? "") ?? UNMOVED))));
  }
}
