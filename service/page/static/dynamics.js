/** What the transmission error excites: run-up and modes of the analyzed pair, and scenes of one's own. */

import { card } from "./card.js";
import { byId } from "./elements.js";
import { sceneOf, wishOf } from "./scene.js";

const SPEEDS = 11;

/** Speeds from 0 to the top, evenly. */
export const evenly = (low, high, count) => Array.from(
  { length: count }, (_, k) => low + (k * (high - low)) / Math.max(count - 1, 1),
);

/** Torque that the brake holds against the middle one of the table, N m on the wheel. */
function brakeOf(known) {
  const ratio = known.case.pair.wheel.teeth / known.case.pair.pinion.teeth;
  const torque = known.torques[Math.floor(known.torques.length / 2)] * ratio;
  return torque >= 10 ? Math.round(torque) : Number(torque.toPrecision(2));
}

/** The scene of an analyzed pair as it is offered first. */
export const usualScene = (known) => sceneOf(known, { top_rpm: 3000, duration_s: 1, torque_n_m: brakeOf(known) });

const RUN_UP = {
  title: "Run-up", action: "Simulate the run-up",
  text: "Time integration from standstill: dynamic transmission error, bearing forces, waterfall over speed, mesh orders.",
  fields: [
    { name: "top_rpm", label: "Top speed, rpm", value: "3000" },
    { name: "duration_s", label: "Duration, s", value: "1" },
    { name: "torque_n_m", label: "Brake on the wheel, N m" },
  ],
};
const MODES = {
  title: "Modes", action: "Find the modes",
  text: "Natural modes about the loaded equilibrium and where multiples of the mesh frequency meet them (Campbell diagram).",
  fields: [{ name: "top_rpm", label: "Top speed, rpm", value: "3000" }],
};

/** Run-up and modes of the pair of the result that is shown. */
export class Dynamics {
  /** @param {{slot: Function, show: Function}} page */
  constructor({ slot, show }) {
    this.known = null;
    byId("dynamics-body").replaceChildren(
      card(RUN_UP, (parts) => slot("simulate", parts, show), (values) => this.runUp(values), ({ inputs }) => wishOf(inputs.scene)),
      card(MODES, (parts) => slot("modes", parts, show), (values) => this.modes(values),
        ({ inputs }) => ({ top_rpm: inputs.speed_rpm.at(-1) })),
    );
  }

  /** @param {object | null} known the analyzed pair */
  show(known) {
    this.known = known;
    const external = known !== null && !known.case.pair.wheel.internal;
    byId("dynamics-none").hidden = external;
    byId("dynamics-body").hidden = !external;
    byId("study-Run-up-torque_n_m").value = external ? String(brakeOf(known)) : "";
  }

  wish(values) {
    return { top_rpm: 3000, duration_s: 1, torque_n_m: brakeOf(this.known), ...values };
  }

  runUp(values) {
    return { process: "simulate", inputs: { scene: sceneOf(this.known, this.wish(values)) } };
  }

  modes(values) {
    const scene = sceneOf(this.known, this.wish({}));
    return { process: "modes", inputs: { scene, speed_rpm: evenly(0, this.wish(values).top_rpm, SPEEDS) } };
  }
}
