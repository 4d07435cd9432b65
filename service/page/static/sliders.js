/** The sliders of the live flanks: torque, misalignment, every depth and length of the flanks, each with its exact number. */

import { folded, make } from "./elements.js";
import { unitOf } from "./field.js";
import { lengthOf } from "./relief_start.js";
import { at, ofFlank } from "./schema.js";

const MAIN = [ // the others are folded away
  "torque_n_m", "pinion.tip_relief_um", "pinion.tip_relief_length_mm", "wheel.tip_relief_um", "wheel.tip_relief_length_mm",
  "pinion.helix_crowning_um", "misalignment_um",
];
const QUICK = "pinion.tip_relief_um"; // beside the curve of a narrow screen
const NARROW = window.matchMedia("(max-width: 62rem)");
const KINDS = ["amount", "slope", "length"]; // of figures that have a slider
const ACROSS = 30; // most of a depth across the face, µm
const USUAL_LENGTH = { profile: 0.5, face: 0.1 }; // normal modules, face widths; where the case has none
const MOST_LENGTH = { profile: 1, face: 0.5 };

const rounded = (value, step) => Number((Math.round(value / step) * step).toPrecision(12));
const depthOf = (name) => name.replace("_length_mm", "_um");

/** The slider of a figure of one flank, as its field declares it. */
function figure(field, { case: content, circles }) {
  const { schema, path: [, gear, name] } = field;
  const own = lengthOf(content.pair[gear], name, circles?.[gear]) ?? schema.default; // a case is written without later figures it does not use
  const along = schema["x-along"].includes("face") ? "face" : "profile";
  const knob = { key: `${gear}.${name}`, label: `${field.label}, ${gear}`, unit: unitOf(name), own, across: along === "face" };
  if (schema["x-kind"] !== "length") return { ...knob, value: own, ...depthRange(knob, schema, content) };
  const scale = along === "face" ? content.pair[gear].face_width_mm : content.pair.normal_module_mm;
  const most = Math.max(MOST_LENGTH[along] * scale, own);
  const step = 10 ** Math.floor(Math.log10(most / 100));
  return { ...knob, depth: `${gear}.${depthOf(name)}`, value: own || rounded(USUAL_LENGTH[along] * scale, step), low: step, high: most, step };
}

function depthRange({ own, across }, schema, content) {
  const most = Math.max(across ? ACROSS : Math.max(20, rounded(12 * content.pair.normal_module_mm, 5)), Math.abs(own));
  return { low: schema["x-kind"] === "slope" ? -most : 0, high: most };
}

/** What the sliders change: name of the value, label, unit, range by case. */
function knobs(known, fields) {
  const flanks = fields.filter(({ name, schema }) => ofFlank(name, schema) && KINDS.includes(schema["x-kind"]));
  return [
    { key: "torque_n_m", label: "Torque on the pinion", unit: "N m", low: 0, high: 2 * known.highest, value: known.torque },
    { key: "misalignment_um", label: "Misalignment", unit: "µm", low: -50, high: 50, value: 0, across: true },
    ...flanks.map((field) => figure(field, known)),
  ];
}

export class Sliders {
  /**
   * @param {object} known the analyzed pair
   * @param {import("./field.js").Field[]} fields of a case
   * @param {() => void} changed called after every move
   */
  constructor(known, fields, changed) {
    this.known = known;
    this.changed = changed;
    this.controls = knobs(known, fields).map((knob) => this.control(knob));
  }

  block(key) {
    return this.controls.find(({ knob }) => knob.key === key).block;
  }

  get blocks() {
    const rest = (gear) => this.controls.filter(({ knob: { key } }) => key.startsWith(`${gear}.`) && !MAIN.includes(key));
    const more = ["pinion", "wheel"].map((gear) => folded(`More of the ${gear}'s flanks`, ...rest(gear).map((control) => control.block)));
    return [...MAIN.map((key) => this.block(key)), ...more];
  }

  control(knob) {
    const id = `live-${knob.key.replace(".", "-")}`;
    const step = knob.step ?? (knob.high > 500 ? 5 : knob.high > 100 ? 1 : knob.high > 20 ? 0.5 : knob.high / 100);
    const low = knob.key === "torque_n_m" ? step : knob.low;
    const disabled = this.known.plane && knob.across;
    const facts = { min: low, max: knob.high, step, disabled };
    const range = make("input", { ...facts, type: "range", id });
    const exact = make("input", { ...facts, id: `${id}-exact`, type: "number", step: "any", "aria-label": `${knob.label}, ${knob.unit}, as a number` });
    const told = () => range.setAttribute("aria-valuetext", `${exact.value} ${knob.unit}`);
    const put = (value) => {
      range.value = value;
      exact.value = value;
      told();
    };
    range.addEventListener("input", () => {
      exact.value = range.value;
      told();
      this.changed();
    });
    exact.addEventListener("input", () => {
      if (exact.value.trim() === "") return; // a number that is not typed yet
      range.value = exact.value;
      told();
      this.changed();
    });
    put(knob.value);
    const label = make("label", { for: id }, `${knob.label}, ${knob.unit}`);
    return { knob, exact, put, told, block: make("div", { class: "slider" }, label, range, exact) };
  }

  /** Show the slider that is looked at in a place of a narrow screen. @param {HTMLElement} place */
  follow(place) {
    const block = this.block(QUICK);
    const home = document.createComment(QUICK);
    block.replaceWith(home);
    const put = () => (NARROW.matches ? place.append(block) : home.after(block));
    NARROW.onchange = put;
    put();
  }

  reset() {
    for (const { knob, put } of this.controls) put(knob.value);
    document.dispatchEvent(new Event("typed"));
    this.changed();
  }

  /** Where they stand, if not as analyzed: flanks and misalignment, and the torque where it was moved. */
  get moved() {
    const torque = this.value("torque_n_m");
    return { ...(torque === this.known.torque ? {} : { torque_n_m: torque }), misalignment_um: this.value("misalignment_um"), ...this.flanks };
  }

  /** Stand where they were moved. @param {any} moved */
  set moved(moved) {
    for (const { knob: { key, value }, put } of this.controls) put(at(moved, key.split(".")) ?? value);
  }

  /** Let another value be the usual one, and stand there. @param {string} key @param {number} value @param {boolean} now */
  stand(key, value, now) {
    const { knob, put } = this.controls.find((control) => control.knob.key === key);
    knob.value = value;
    if (now) put(value);
  }

  /** Move a slider. @param {string} key @param {number} value */
  put(key, value) {
    this.controls.find((control) => control.knob.key === key).put(value);
    document.dispatchEvent(new Event("typed"));
    this.changed();
  }

  /** Say the values anew, which were put there from outside. */
  told() {
    for (const { told } of this.controls) told();
  }

  value(key) {
    const { knob, exact } = this.controls.find((control) => control.knob.key === key);
    return exact.value.trim() === "" ? knob.value : Number(exact.value);
  }

  /** Modifications that differ from those of the case, by gear and field; a length goes with a depth that is not 0. */
  get flanks() {
    const changes = { pinion: {}, wheel: {} };
    for (const { knob } of this.controls) {
      const [gear, name] = knob.key.split(".");
      const value = this.value(knob.key);
      if (!name || value === knob.own || (knob.depth && this.value(knob.depth) === 0)) continue;
      changes[gear][name] = value;
    }
    return changes;
  }
}
