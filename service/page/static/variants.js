// @ts-check
/** Variants of a design, A to C: each a copy of the fields or a result, all in the address; their curves stand side by side. */

import { HASH, JOB } from "./address.js";
import { byId, make } from "./elements.js";
import { caseOf } from "./orders.js";
import { pack } from "./packed.js";
import { Reference } from "./reference.js";

const LETTERS = ["a", "b", "c"];
const FIRST = "first"; // the first example with the result that came with the program
const UNMOVED = { misalignment_um: 0, pinion: {}, wheel: {} };

export class Variants {
  /**
   * @param {{address: import("./address.js").Address, design: import("./design.js").Design}} page
   * @param {() => Promise<void>} render shows what the address says
   */
  constructor({ address, design }, render) {
    Object.assign(this, { address, design, render });
  }

  get on() {
    return this.address.views.get("on") ?? LETTERS[0];
  }

  /** What the variant that is shown is called in an address: its design as typed, its job, or its result. */
  get word() {
    const { names, views, empty } = this.address;
    if (empty) return FIRST;
    return names.get("analyze") ?? views.get("case") ?? names.get("database") ?? pack(this.design.case);
  }

  /** Offer the variants of this address. */
  offer() {
    const known = LETTERS.filter((letter) => letter === this.on || this.address.views.has(letter));
    const next = LETTERS.find((letter) => !known.includes(letter));
    const button = (letter) => make("button", {
      type: "button", "aria-pressed": String(letter === this.on), "aria-label": `Variant ${letter.toUpperCase()}`, onclick: () => this.choose(letter),
    }, letter.toUpperCase());
    const add = next && make("button", { type: "button", "aria-label": "Another variant: a copy of this one", onclick: () => this.add(next) }, "+");
    byId("variants").replaceChildren(...known.map(button), add ?? "");
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
    const word = this.address.views.get(letter);
    const of = HASH.test(word) ? { database: word } : JOB.test(word) ? { analyze: word } : {};
    const views = { [this.on]: this.word, [letter]: null, on: letter, case: Object.keys(of).length || word === FIRST ? null : word };
    this.address.turn(of, views, {});
    await this.render();
    byId("variants").querySelector("[aria-pressed=true]").focus();
  }

  /** The results of the other variants, to draw beside this one. @returns {Promise<{name: string, reference: Reference}[]>} */
  async others() {
    const words = LETTERS.filter((letter) => letter !== this.on).map((letter) => ({ name: letter, key: this.address.views.get(letter) ?? "" }));
    const known = await Promise.all(words.filter(({ key }) => HASH.test(key)).map(async ({ name, key }) => ({ name, key, case: await caseOf(key) })));
    return known.map(({ name, ...of }) => ({ name, reference: new Reference(of, UNMOVED) }));
  }
}
