// @ts-check
/** Variants of a design, A to C: each a copy of the fields or a result, all in the address; their curves stand side by side. */

import { HASH, JOB } from "./address.js";
import { Problem, ask, get, guarded, patiently } from "./api.js";
import { button, byId, make } from "./elements.js";
import { followed, orderOf, referenceOf, showFailure, submitted } from "./job.js";
import { caseOf } from "./orders.js";
import { pack, unpack } from "./packed.js";
import { circlesOf, flankOf } from "./relief_start.js";

const LETTERS = ["a", "b", "c"];
const FIRST = "first"; // the first example with the result that came with the program
const KEPT = 8; // curves of another result
export const UNMOVED = { misalignment_um: 0, pinion: {}, wheel: {} };

/** @typedef {{key: string, case: any}} Known an analyzed pair */
/** @typedef {{torque_n_m?: number, misalignment_um: number, pinion: object, wheel: object}} Moved where sliders stand */

/** @typedef {{name: string, content: any, key?: string, moved?: Moved, job?: string}} Variant its case, and its result if there is one */

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
    this.refused = "";
    if (this.curves.has(torque)) return this.curves.get(torque);
    try {
      const body = { ...this.flanks, torque_n_m: [torque], flanks: true, caller: `${caller}-${this.name}` };
      const [curve] = (await ask(`${this.known.key}/ste`, body)).curves;
      if (this.curves.size >= KEPT) this.curves.clear();
      this.curves.set(torque, curve);
      return curve;
    } catch (problem) {
      if (!(problem instanceof Problem) || problem.status === 0 || problem.retryAfter) throw problem;
      this.refused = `${this.name.toUpperCase()}: ${problem.message}`;
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
    this.waiting?.abort();
    byId("unanswered").replaceChildren();
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
    await this.go(Object.fromEntries(this.address.names), { [this.on]: this.word, on: letter });
  }

  /** Show another variant: a design as typed on the bodies of a result, where one has them. @param {string} letter */
  async choose(letter) {
    if (letter === this.on) return;
    const word = this.address.views.get(letter);
    const [of, live, typed] = HASH.test(word.split(".")[0]) ? word.split(".") : [];
    const content = of || JOB.test(word) ? null : unpack(word);
    const found = content && await this.bodiesOf(content, await this.results());
    const names = of ? { database: of } : JOB.test(word) ? { analyze: word } : found ? { database: found.known.key } : {};
    const views = { live: live || (found && pack(found.moved)), case: typed ?? (content && word) };
    await this.go(names, { [this.on]: this.word, [letter]: null, on: letter, ...views }, {});
  }

  /** @param {Record<string, string>} names @param {Record<string, string | null>} views @param {object} [kept] */
  async go(names, views, kept) {
    this.address.turn(names, views, kept);
    await this.render();
    byId("variants").querySelector("[aria-pressed=true]").focus();
  }

  /** A variant that is not shown. @param {string} name @returns {Promise<Variant>} */
  async variant(name) {
    const [word, live] = this.address.views.get(name).split(".");
    if (HASH.test(word)) return { name, key: word, content: await caseOf(word), moved: unpack(live ?? "") ?? UNMOVED };
    if (!JOB.test(word)) return { name, content: word === FIRST ? this.design.example.case : unpack(word) };
    const [{ status }, { inputs }] = await Promise.all([patiently(() => get(`/v1/jobs/${word}`)), orderOf(word)]);
    const done = status === "successful";
    return { name, content: inputs.case, ...(done ? { key: (await referenceOf(word)).hash, moved: UNMOVED } : { job: word }) };
  }

  /** The results of the address, each with its case. @returns {Promise<Known[]>} */
  async results() {
    const words = [this.address.get("database"), ...LETTERS.map((name) => this.address.views.get(name)?.split(".")[0])];
    const keys = [...new Set(words.filter((word) => HASH.test(word ?? "")))];
    return (await Promise.all(keys.map(async (key) => ({ key, case: await caseOf(key) })))).filter((known) => known.case);
  }

  /**
   * A result whose bodies are those of a case, and where the case's flanks stand on it.
   * @param {any} content @param {Known[]} results @returns {Promise<{known: Known, moved: Moved} | undefined>}
   */
  async bodiesOf(content, results) {
    for (const known of results) {
      const fields = this.design.edits(known.case, content).map(({ field }) => field).filter(({ path }) => path[0] !== "load");
      if (!fields.every(({ schema }) => schema["x-along"]?.length)) continue;
      const [circles, moved] = [await circlesOf(content), { ...UNMOVED, pinion: {}, wheel: {} }];
      for (const field of fields) Object.assign(moved[field.path[1]], flankOf(field, content, circles));
      return { known, moved };
    }
    return undefined;
  }

  /** The other variants that have curves, to draw beside this one; of those that have none the dock says why. @returns {Promise<Other[]>} */
  async others() {
    const names = LETTERS.filter((letter) => letter !== this.on && this.address.views.has(letter));
    const variants = await Promise.all(names.map((name) => guarded(() => this.variant(name), () => ({ name, content: null }))));
    const results = names.length ? await this.results() : [];
    const found = await Promise.all(variants.map(async ({ key, content, moved }) => (
      key && content ? { known: { key, case: content }, moved } : content && this.bodiesOf(content, results))));
    this.without(variants.filter((_, k) => !found[k]));
    return variants.flatMap(({ name }, k) => (found[k] ? [new Other(name, found[k].known, found[k].moved)] : []));
  }

  /** Say what variants without curves need. @param {Variant[]} variants */
  without(variants) {
    this.waiting?.abort();
    this.waiting = new AbortController();
    byId("unanswered").replaceChildren(...variants.map((variant) => this.need(variant, this.waiting.signal)));
  }

  /** @param {Variant} variant @param {AbortSignal} signal */
  need({ name, content, job }, signal) {
    const letter = name.toUpperCase();
    const words = job ? "" : content ? "not analyzed, and no result here has its gears." : "not known to this service.";
    const node = make("div", {});
    const line = make("div", { role: "group", "aria-label": `Variant ${letter}` }, make("p", { class: "hint" }, `${letter}: ${words}`), node);
    const again = (/** @type {() => Promise<any>} */ action) => guarded(async () => {
      await action();
      if (!signal.aborted) await this.page.results.live.restored();
    }, (problem) => signal.aborted || showFailure(node, problem));
    const analyze = async () => {
      const { jobID } = await submitted(node, "analyze", { inputs: { case: this.design.submitted(content) }, title: this.address.views.get("name") ?? "" });
      if (!signal.aborted) this.address.look(name, jobID);
    };
    if (job) again(() => followed(node, job, { signal }));
    else if (content) node.append(button(`Analyze ${letter}`, () => again(analyze), { class: "small" }));
    return line;
  }
}
