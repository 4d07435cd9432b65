/** The sliders of the live flanks: torque, tip relief, crowning, misalignment, each with its exact number. */

import { make } from "./elements.js";

const RELIEF_LENGTH = 0.5; // normal modules, where the case has no relief to take it from
const ACROSS = ["helix_crowning_um", "misalignment_um"];

const rounded = (value, step) => Math.round(value / step) * step;

/** What the sliders change: name of the value, label, unit, range by case. */
function knobs(known) {
  const relief = Math.max(20, rounded(12 * known.case.pair.normal_module_mm, 5));
  const gear = (name) => known.case.pair[name];
  return [
    { key: "torque_n_m", label: "Torque on the pinion", unit: "N m", low: 0, high: 2 * known.highest, value: known.torque },
    { key: "pinion.tip_relief_um", label: "Tip relief, pinion", unit: "µm", low: 0, high: relief, value: gear("pinion").tip_relief_um },
    { key: "wheel.tip_relief_um", label: "Tip relief, wheel", unit: "µm", low: 0, high: relief, value: gear("wheel").tip_relief_um },
    { key: "pinion.helix_crowning_um", label: "Crowning, pinion", unit: "µm", low: 0, high: 30, value: gear("pinion").helix_crowning_um },
    { key: "misalignment_um", label: "Misalignment", unit: "µm", low: -50, high: 50, value: 0 },
  ];
}

export class Sliders {
  /**
   * @param {object} known the analysed pair
   * @param {() => void} changed called after every move
   */
  constructor(known, changed) {
    this.known = known;
    this.changed = changed;
    this.controls = knobs(known).map((knob) => this.control(knob));
  }

  get blocks() {
    return this.controls.map(({ block }) => block);
  }

  control(knob) {
    const id = `live-${knob.key.replace(".", "-")}`;
    const step = knob.high > 500 ? 5 : knob.high > 100 ? 1 : knob.high > 20 ? 0.5 : knob.high / 100;
    const low = knob.key === "torque_n_m" ? step : knob.low;
    const disabled = this.known.plane && ACROSS.some((name) => knob.key.endsWith(name));
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
      if (name === "tip_relief_um" && !pair[gear].tip_relief_length_mm) {
        changes[gear].tip_relief_length_mm = RELIEF_LENGTH * pair.normal_module_mm;
      }
    }
    return changes;
  }
}
