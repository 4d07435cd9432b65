/** Jobs beside the analysis: flank pressure, ladder, sensitivity, and the dynamics of the pair. */

import { Problem } from "./api.js";
import { byId, make } from "./elements.js";
import { runJob, showFailure } from "./job.js";
import { optimisationOf, showOptimisation } from "./optimise.js";
import { showReport } from "./report.js";
import { sceneOf } from "./scene.js";

const STUDIES = [
  {
    process: "flank", title: "Flank pressure", action: "Compute flank pressure",
    text: "Contact pressure, line load and gap on the flanks over a mesh cycle, at one load and misalignment.",
    fields: [["torque_n_m", "Torque on the pinion, N m", ""], ["misalignment_um", "Misalignment, µm", ""]],
    inputs: (found, values) => ({ case: found, ...values }),
  },
  {
    process: "frontier", title: "Accuracy frontier", action: "Climb the accuracy ladder",
    text: "Error against time of every way to compute this case, from closed forms to the finest mesh. Takes minutes in three dimensions.",
    fields: [],
    inputs: (found) => ({ case: found }),
  },
  {
    process: "sensitivity", title: "Sensitivity", action: "Study the sensitivity",
    text: "Peak to peak over misalignment and centre distance, without and with corner contact, in three dimensions.",
    fields: [],
    inputs: (found) => ({ case: found }),
  },
  {
    process: "optimise", title: "Optimise the flanks", action: "Search better flanks",
    text: "Tip relief of both gears (and crowning, in three dimensions) of least expected peak to peak over the torques of the case.",
    fields: [["relief_um", "Most tip relief, µm", "40"], ["scatter_um", "Misalignment, standard deviation, µm", "10"]],
    inputs: optimisationOf,
    show: (result, reference, page) => showOptimisation(result, reference, page.take),
  },
];

/** One study: its fields, a button, progress and what came out. */
function card({ title, text, fields, action, level = "h3" }, start) {
  const inputs = fields.map(([name, label, value]) => {
    const input = make("input", { type: "text", inputmode: "decimal", id: `study-${title}-${name}`.replaceAll(" ", "-"), size: 8 });
    input.value = value;
    return { name, input, block: make("span", { class: "row" }, make("label", { for: input.id }, label), input) };
  });
  const progress = make("div");
  const result = make("div");
  const button = make("button", { type: "button" }, action);
  button.addEventListener("click", async () => {
    button.disabled = true;
    result.replaceChildren();
    try {
      const values = Object.fromEntries(inputs.filter(({ input }) => input.value.trim() !== "").map(
        ({ name, input }) => [name, Number(input.value.replace(",", "."))],
      ));
      await start(values, progress, result);
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      showFailure(progress, problem);
    } finally {
      button.disabled = false;
    }
  });
  const row = make("div", { class: "row" }, ...inputs.map(({ block }) => block), button);
  return make("div", {}, make(level, {}, title), make("p", { class: "hint" }, text), row, progress, result);
}

/** @param {{case: () => object, offered: Set<string>, take: (flanks: object) => void}} page */
export function showStudies(page) {
  const offered = STUDIES.filter(({ process }) => page.offered.has(process));
  byId("study-list").replaceChildren(...offered.map((study) => card(study, async (values, progress, result) => {
    const reference = await runJob(progress, study.process, study.inputs(page.case(), values));
    await (study.show ?? showReport)(result, reference, page);
  })));
}

const MOTION = [
  ["top_rpm", "Top speed, rpm", "3000"], ["duration_s", "Duration, s", "1"], ["torque_n_m", "Brake on the wheel, N m", ""],
];

/** Offer the dynamics of an analysed pair. */
export function showDynamics(known) {
  const external = known !== null && !known.case.pair.wheel.internal;
  byId("dynamics-none").hidden = external;
  byId("dynamics-body").hidden = !external;
  if (!external) return;
  const ratio = known.case.pair.wheel.teeth / known.case.pair.pinion.teeth;
  const brake = String(Math.round(known.torques[Math.floor(known.torques.length / 2)] * ratio));
  const fields = MOTION.map(([name, label, value]) => [name, label, value || brake]);
  const wish = (values) => ({ top_rpm: 3000, duration_s: 1, torque_n_m: Number(brake), ...values });
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
    const speeds = Array.from({ length: 11 }, (_, k) => (k * top) / 10);
    const reference = await runJob(progress, "modes", { scene: sceneOf(known, wish({})), speed_rpm: speeds });
    await showReport(result, reference);
  });
  byId("dynamics-body").replaceChildren(run, modes);
}
