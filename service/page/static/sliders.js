/** The sliders of the live flanks: torque, misalignment and every depth of the flanks, each with its exact number. */

import { folded, make } from "./elements.js";

const MAIN = ["pinion.tip_relief_um", "wheel.tip_relief_um", "pinion.helix_crowning_um"]; // the others are folded away
const DEPTHS = ["amount", "slope"]; // kinds of figures that have a slider
const ACROSS = 30; // most of a depth across the face, µm
const RELIEF_LENGTH = { profile: 0.5, face: 0.1 }; // normal modules, face widths; where the case has no relief to take it from

const rounded = (value, step) => Math.round(value / step) * step;

/** The slider of a depth of one flank, as its field declares it. */
function depth(field, content) {
  const [, gear, name] = field.path;
  const value = content.pair[gear][name];
  const across = field.schema["x-along"].includes("face");
  const most = Math.max(across ? ACROSS : Math.max(20, rounded(12 * content.pair.normal_module_mm, 5)), Math.abs(value));
  const low = field.schema["x-kind"] === "slope" ? -most : 0;
  return { key: `${gear}.${name}`, label: `${field.label}, ${gear}`, unit: "µm", low, high: most, value, across };
}

/** What the sliders change: name of the value, label, unit, range by case. */
function knobs(known, fields) {
  const flanks = fields.filter(({ schema }) => DEPTHS.includes(schema["x-kind"]));
  return [
    { key: "torque_n_m", label: "Torque on the pinion", unit: "N m", low: 0, high: 2 * known.highest, value: known.torque },
    { key: "misalignment_um", label: "Misalignment", unit: "µm", low: -50, high: 50, value: 0, across: true },
    ...flanks.map((field) => depth(field, known.case)),
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

  get blocks() {
    const block = (key) => this.controls.find(({ knob }) => knob.key === key).block;
    const main = ["torque_n_m", ...MAIN, "misalignment_um"];
    const rest = this.controls.filter(({ knob }) => !main.includes(knob.key));
    return [...main.map(block), folded("More flank modifications", ...rest.map((control) => control.block))];
  }

  control(knob) {
    const id = `live-${knob.key.replace(".", "-")}`;
    const step = knob.high > 500 ? 5 : knob.high > 100 ? 1 : knob.high > 20 ? 0.5 : knob.high / 100;
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

  reset() {
    for (const { knob, put } of this.controls) put(knob.value);
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

  /** Modifications that differ from those of the case, by gear and field. */
  get flanks() {
    const changes = { pinion: {}, wheel: {} };
    for (const { knob } of this.controls) {
      const [gear, name] = knob.key.split(".");
      if (!name || this.value(knob.key) === knob.value) continue;
      changes[gear][name] = this.value(knob.key);
      const { pair } = this.known.case;
      const length = name.replace("_um", "_length_mm");
      if (pair[gear][length] === 0) {
        changes[gear][length] = knob.across ? RELIEF_LENGTH.face * pair[gear].face_width_mm : RELIEF_LENGTH.profile * pair.normal_module_mm;
      }
    }
    return changes;
  }
}
