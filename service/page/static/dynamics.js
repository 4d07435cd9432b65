/** What the transmission error excites: run-up and modes of the analysed pair, and scenes of one's own. */

import { card } from "./card.js";
import { byId } from "./elements.js";
import { runJob } from "./job.js";
import { showReport } from "./report.js";
import { sceneOf } from "./scene.js";

const SPEEDS = 11;

/** Speeds from 0 to the top, evenly. */
export const evenly = (low, high, count) => Array.from(
  { length: count }, (_, k) => low + (k * (high - low)) / Math.max(count - 1, 1),
);

/** Offer the dynamics of an analysed pair. */
export function showDynamics(known) {
  const external = known !== null && !known.case.pair.wheel.internal;
  byId("dynamics-none").hidden = external;
  byId("dynamics-body").hidden = !external;
  if (!external) return;
  byId("dynamics-body").replaceChildren(...dynamicsCards(known));
}

/** Torque that the brake holds against the middle one of the table, N m on the wheel. */
function brakeOf(known) {
  const ratio = known.case.pair.wheel.teeth / known.case.pair.pinion.teeth;
  const torque = known.torques[Math.floor(known.torques.length / 2)] * ratio;
  return torque >= 10 ? Math.round(torque) : Number(torque.toPrecision(2));
}

/** The scene of an analysed pair as it is offered first. */
export const usualScene = (known) => sceneOf(known, { top_rpm: 3000, duration_s: 1, torque_n_m: brakeOf(known) });

function dynamicsCards(known) {
  const brake = brakeOf(known);
  const fields = [
    { name: "top_rpm", label: "Top speed, rpm", value: "3000" },
    { name: "duration_s", label: "Duration, s", value: "1" },
    { name: "torque_n_m", label: "Brake on the wheel, N m", value: String(brake) },
  ];
  const wish = (values) => ({ top_rpm: 3000, duration_s: 1, torque_n_m: brake, ...values });
  const run = card({
    title: "Run-up", action: "Simulate the run-up", fields,
    text: "Time integration from standstill: dynamic transmission error, bearing forces, waterfall over speed, mesh orders.",
  }, async (values, progress, result) => {
    const reference = await runJob(progress, "simulate", { scene: sceneOf(known, wish(values)) });
    await showReport(result, reference);
  });
  const modes = card({
    title: "Modes", action: "Find the modes", fields: [fields[0]],
    text: "Natural modes about the loaded equilibrium and where multiples of the mesh frequency meet them (Campbell diagram).",
  }, async (values, progress, result) => {
    const { top_rpm: top } = wish(values);
    const inputs = { scene: sceneOf(known, wish({})), speed_rpm: evenly(0, top, SPEEDS) };
    await showReport(result, await runJob(progress, "modes", inputs));
  });
  return [run, modes];
}
