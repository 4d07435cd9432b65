/** A scene of dynamics around an analyzed pair: two shafts, four elastic bearings, motor and brake; its run-up and modes. */

import { card } from "./card.js";
import { byId, save } from "./elements.js";
import { bytesOf, inflated } from "./packed.js";

const SPAN = 200;
const SPEEDS = 11;

/** Speeds from one to another, evenly. */
export const evenly = (low, high, count) => Array.from(
  { length: count }, (_, k) => low + (k * (high - low)) / Math.max(count - 1, 1),
);

/** Save a scene file and the files that it names. @param {{toml: string, files: {name: string, content: string}[]}} scene */
export async function saveScene({ toml, files }) {
  save(toml, "scene.toml", "application/toml");
  for (const { name, content } of files) save(new Blob([await inflated(bytesOf(content))]), name);
}

/**
 * @param {object} known the analyzed pair: its case and the hash of its table
 * @param {{top_rpm: number, duration_s: number, torque_n_m: number}} [wish] torque of the brake on the driven gear
 */
export function sceneOf(known, { top_rpm: top, duration_s: duration, torque_n_m: torque } = usual(known)) {
  const { pair } = known.case;
  const shaft = (name, gear, x) => ({ name, length_mm: SPAN, diameter_mm: pair[gear].bore_diameter_mm, origin_mm: [x, 0, 0] });
  const gear = (name, on) => ({ name, shaft: on, position_mm: SPAN / 2, bore_diameter_mm: pair[name].bore_diameter_mm });
  const bearing = (on, side, place) => ({
    name: `${on} ${side}`, shaft: on, position_mm: place, radial_stiffness_n_per_m: 1e8, axial_stiffness_n_per_m: 1e8,
    damping_ratio: 0.05,
  });
  return {
    run: { duration_s: duration },
    effects: { flexible_shafts: "off" },
    shafts: [shaft("input", "pinion", 0), shaft("output", "wheel", pair.center_distance_mm)],
    gears: [gear("pinion", "input"), gear("wheel", "output")],
    bushings: ["input", "output"].flatMap((on) => [bearing(on, "left", 0), bearing(on, "right", SPAN)]),
    meshes: [{
      name: "mesh", driver: "pinion", driven: "wheel", database_hash: known.key, technique: "variable_torque", damping_ratio: 0.1,
    }],
    drives: [{ name: "motor", shaft: "input", time_s: [0, duration], speed_rpm: [0, top] }],
    loads: [{ name: "brake", shaft: "output", torque_n_m: [torque] }],
    outputs: { bearing_forces: true },
  };
}

/** A run-up as it is offered first: the brake holds against the middle torque of the table. */
function usual({ torques, case: { pair } }) {
  const torque = torques[Math.floor(torques.length / 2)] * (pair.wheel.teeth / pair.pinion.teeth);
  return { top_rpm: 3000, duration_s: 1, torque_n_m: torque >= 10 ? Math.round(torque) : Number(torque.toPrecision(2)) };
}

const TOP = { top_rpm: { type: "number", title: "Top speed, rpm", default: 3000 } };
const RUN_UP = {
  process: "simulate", title: "Run-up", action: "Simulate the run-up",
  text: "Time integration from standstill: dynamic transmission error, bearing forces, waterfall over speed, mesh orders.",
  fields: {
    ...TOP, duration_s: { type: "number", title: "Duration, s", default: 1 },
    torque_n_m: { type: "number", title: "Brake on the wheel, N m" },
  },
};

/** Run-up and modes of the pair of the result that is shown. */
export class Dynamics {
  /** @param {import("./card.js").Study} modes of a scene @param {{slot: Function, show: Function}} page */
  constructor(modes, page) {
    const scene = (values) => sceneOf(this.known, { ...usual(this.known), ...values });
    byId("dynamics-body").replaceChildren(
      card(RUN_UP, page, (values) => ({ inputs: { scene: scene(values) } }), { typed: ({ inputs: { scene: { run, drives, loads } } }) => (
        { top_rpm: drives?.[0]?.speed_rpm.at(-1), duration_s: run.duration_s, torque_n_m: loads?.[0]?.torque_n_m[0] }) }),
      card({ ...modes, fields: TOP }, page, ({ top_rpm: top }) => ({ inputs: { scene: scene({}), speed_rpm: evenly(0, top, SPEEDS) } }),
        { typed: ({ inputs }) => ({ top_rpm: inputs.speed_rpm.at(-1) }) }),
    );
  }

  /** @param {object | null} known the analyzed pair */
  show(known) {
    this.known = known;
    const external = known !== null && !known.case.pair.wheel.internal;
    byId("dynamics-none").hidden = external;
    byId("dynamics-body").hidden = !external;
    byId("study-Run-up-torque_n_m").value = external ? String(usual(known).torque_n_m) : "";
  }
}
