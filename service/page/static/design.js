// @ts-check
/** The design: the case as typed, where it came from, its drawing and its plan, and how it differs from another. */

import { ask, guarded } from "./api.js";
import { differences } from "./comparison.js";
import { heardIn } from "./complaint.js";
import { retype } from "./controls.js";
import { Drawing } from "./drawing.js";
import { button, byId, make } from "./elements.js";
import { CaseForm } from "./form.js";
import { noPlan, showPlan } from "./plan.js";
import { pairAlone, same } from "./schema.js";
import { View } from "./view.js";

export const SETTLED = 350; // milliseconds without an edit after which the case is planned and drawn
export const EMPTY = { name: "empty", title: "Empty fields, to type a pair", note: "", case: {} };
const PLANE = /^plane/;
const BESIDE = ["complaint", "report"]; // no curve depends on them

export class Design {
  /**
   * @param {object} schema of a case
   * @param {object[]} effects what the service offers
   * @param {{name: string, title: string, note: string, case: object}[]} examples
   * @param {{address: import("./address.js").Address, caller: string}} page by whom plans are asked for
   */
  constructor(schema, effects, examples, { address, caller }) {
    this.address = address;
    this.caller = caller;
    this.examples = [...examples, EMPTY];
    this.watchers = [];
    this.settled = () => {}; // called when nobody has typed for a moment
    this.left = () => {}; // called when another design is put into the form
    this.stands = false; // whether the form holds what the address says, or what was typed since
    /** @type {Promise<void> | null} of a file that is read into the form: jobs wait for it */
    this.reading = null;
    this.drawing = new Drawing();
    this.view = new View(byId("view"), () => {
      address.look("see", null);
      this.left();
    });
    this.form = new CaseForm(schema, effects, () => this.edited());
    this.offer();
  }

  /** @param {() => void} watcher called after every change of the design */
  watch(watcher) {
    this.watchers.push(watcher);
  }

  get case() {
    return this.form.case;
  }

  /** A case as it is submitted: of the pair of a unit without a complaint that another mesh is heard by. @param {any} [content] left out: as typed */
  submitted(content = this.case) {
    const { order, harmonic } = heardIn(content);
    const elsewhere = this.address.views.has("unit") && Number.isFinite(order) && !harmonic;
    return elsewhere ? { ...content, complaint: undefined } : content;
  }

  /** What it is called. */
  get name() {
    return byId("name").value.trim();
  }

  /** Fields of the case, each with its words. */
  get fields() {
    return this.form.fields.values();
  }

  /** @param {string} key */
  field(key) {
    return this.form.fields.get(key);
  }

  /** What was edited since a case. @param {object} content */
  differences(content) {
    return differences(this.fields, content, this.case);
  }

  /** Those of them that a result depends on. @param {object} content @param {object} [now] left out: as typed */
  edits(content, now = this.case) {
    return differences(this.fields, content, now).filter(({ field }) => !BESIDE.includes(field.path[0]));
  }

  offer() {
    const list = byId("example");
    const opened = make("option", { value: "", hidden: true }, "the pair below");
    list.replaceChildren(opened, ...this.examples.map(({ name, title }) => make("option", { value: name }, title)));
    list.addEventListener("change", () => {
      const { name, note, case: content } = this.examples.find((example) => example.name === list.value);
      this.goTo(content, note, { example: name, name: "" });
    });
  }

  /** The pair of a page that is opened without an address. */
  get example() {
    return this.examples[0];
  }

  /** Begin with a pair of the list. */
  begin({ name, note, case: content } = this.example) {
    this.show(content, { example: name, note });
  }

  /**
   * Put another design into the form: a new entry of the history, so that the way back leads to the one that is replaced.
   * @param {object} content a case
   * @param {string} note where it comes from
   * @param {{example?: string, name?: string}} [as] its name in the list, and what it is called; left out: as before, and of the
   *   same unit
   */
  goTo(content, note, { example = "", name } = {}) {
    const another = name !== undefined; // of which the result is none
    this.address.push({});
    this.address.view(another ? { see: null, unit: null, live: null, name } : { see: null });
    if (another) byId("name").value = name;
    this.left();
    const replaced = differences(this.fields, this.case, content).filter(({ field }) => field.path[0] !== "pair");
    const changes = replaced.map(({ text }) => text).filter(Boolean);
    this.show(content, { example, note, replaced: changes.length ? `Settings replaced with it: ${changes.join(", ")}.` : "" });
    this.settled();
    this.address.keep(this.address.typed());
    if (another) document.dispatchEvent(new Event("another"));
    for (const { field } of replaced) field.entry.classList.add("replaced");
  }

  show(content, origin = { example: "", note: "" }) {
    this.form.case = content;
    this.from(origin);
    this.changed();
    this.look();
  }

  /** Show what was typed when the address was left. */
  restore({ fields, origin }) {
    this.form.clear();
    retype(fields, byId("main"));
    this.from(origin ?? { example: "", note: "" });
    this.changed();
    this.look();
  }

  from(origin) {
    this.stands = true;
    byId("example").value = origin.example;
    byId("example-note").textContent = origin.note;
    byId("example-replaced").textContent = origin.replaced ?? "";
    this.address.keep({ origin });
  }

  /** @param {Record<string, any>} values by field of the case */
  take(values) {
    for (const [key, value] of Object.entries(values)) this.form.set(key, value);
    this.edited();
  }

  changed() {
    document.dispatchEvent(new Event("typed"));
    for (const watcher of this.watchers) watcher();
  }

  edited() {
    if (byId("example").value || !this.stands) this.from({ note: "", ...this.address.kept.origin, example: "" });
    this.changed();
    if (this.drawnPair && !same(this.drawnPair, this.case.pair)) this.drawing.stale();
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.settled();
      this.look();
    }, SETTLED);
  }

  /** Draw and plan what the form holds, and give up what an earlier look asked for; refusals go to their fields. */
  async look() {
    clearTimeout(this.timer);
    this.looking?.abort();
    const { signal } = (this.looking = new AbortController());
    const body = { inputs: { case: this.submitted() } };
    let drawn = false;
    await guarded(async () => {
      const outline = await ask("outline", { inputs: { case: pairAlone(this.case) } }, signal);
      if (signal.aborted) return;
      this.form.clear();
      this.drawing.show(outline);
      this.drawnPair = body.inputs.case.pair;
      this.view.show(outline);
      drawn = true;
      if (this.expected === undefined) noPlan("Time and memory are being predicted.");
      const plan = await ask("plan", { inputs: { ...body.inputs, study: "optimize" }, caller: this.caller }, signal);
      if (!signal.aborted) this.expected = showPlan(plan);
    }, (problem) => {
      if (signal.aborted || problem.status === 0) return; // asked again when the service is back
      this.refuse(problem);
      this.expected = undefined;
      noPlan("No plan yet: see above what is missing.");
      if (!drawn) this.drawing.stale();
    });
  }

  /** @param {import("./api.js").Problem} problem @param {{focus?: boolean}} [options] whether the list of faults takes the focus */
  refuse(problem, options) {
    this.form.refuse(problem, options);
    if (this.helixInThePlane) byId("form-errors").append(this.threeDimensions());
  }

  get helixInThePlane() {
    const { pair, accuracy } = this.form.case;
    return Boolean(pair?.helix_angle_deg) && PLANE.test(accuracy?.model ?? "");
  }

  /** What a helical pair with a model of the plane is told. */
  threeDimensions() {
    const model = this.field("accuracy.model").input.selectedOptions[0].text;
    return make(
      "div", {}, make("p", {}, `The pair is helical, and the model “${model}” computes one transverse section: a spur pair. `
        + "Its contact lines run across the face, which takes three dimensions."),
      button("Set the model to 3d", () => this.take({ "accuracy.model": "3d" }), { class: "small" }),
    );
  }
}
