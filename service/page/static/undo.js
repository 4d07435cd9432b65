// @ts-check
/** Undo and redo: what the design was, as often as somebody came to rest. */

import { byId } from "./elements.js";
import { same } from "./schema.js";

const RESTED = 400; // milliseconds without an edit
const MOST = 200;
const TEXT = "textarea, input:not([type=range], [type=checkbox], [type=file])"; // they undo what is typed in them

/** @typedef {{case: object, origin?: object, ofResult?: {key: string}, ofScene?: {scene: any}}} State a design,
 * where it came from, its moved flanks, and the scene */

export class Undo {
  /** @param {() => State} now @param {(state: State) => Promise<void>} put */
  constructor(now, put) {
    Object.assign(this, { now, put });
    this.buttons = [byId("undo"), byId("redo")];
    this.buttons.forEach((button, k) => button.addEventListener("click", () => this.go(k)));
    for (const name of ["input", "typed"]) document.addEventListener(name, () => this.wait());
    document.addEventListener("opened", () => this.note());
    document.addEventListener("keydown", (event) => this.key(event));
    this.begin();
  }

  /** Begin anew with what is shown. */
  begin() {
    clearTimeout(this.timer);
    /** @type {State[][]} what was, and what was undone */
    this.states = [[], []];
    this.shown = this.now();
    this.offer();
  }

  wait() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.note(), RESTED);
  }

  /** Take a step, if anything was edited: a result that is opened is no edit. */
  note() {
    clearTimeout(this.timer);
    if (this.going) return;
    const [before, now] = [this.shown, this.now()];
    for (const [part, value] of Object.entries(now)) if (value === before[part] || same(value, before[part])) now[part] = before[part]; // held once
    this.shown = now;
    if (!["case", "ofResult", "ofScene"].some((part) => before[part]?.key === now[part]?.key && before[part] !== now[part])) return;
    this.states = [[...this.states[0].slice(1 - MOST), before], []];
    this.offer();
  }

  /** @param {number} way 0 back, 1 forth */
  async go(way) {
    this.note();
    const state = this.states[way].pop();
    if (!state) return;
    this.states[1 - way].push(this.shown);
    this.going = true;
    await this.put(state).finally(() => { this.going = false; });
    this.shown = this.now();
    this.offer();
  }

  offer() {
    this.buttons.forEach((button, k) => { button.disabled = !this.states[k].length; });
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const letter = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || !"zy".includes(letter) || /** @type {Element} */ (event.target).matches(TEXT)) return;
    event.preventDefault();
    this.go(letter === "y" || event.shiftKey ? 1 : 0);
  }
}
