/** The plan of a run: time, memory, error of every mesh, and the effect ledger, before anything starts. */

import { byId, dataTable, duration, figures, folded, make, number } from "./elements.js";

const percent = (share) => number(100 * share, 2);

/** @param {object} found answer of /v1/drafts/plan */
export function showPlan(found) {
  const head = make("dl", { class: "headline" });
  const { choice, error, passes } = found;
  const seconds = passes.reduce((sum, { cost }) => sum + cost.cpu_seconds, 0);
  byId("cost-optimize").textContent = found.study ? `Takes ${found.study.words}.` : "";
  figures(head, [
    ["model", choice.model, passes.map(({ level }) => level).join(", then ")],
    ["time", duration(seconds), "of one processor"],
    ["memory", `${Math.round(Math.max(...passes.map(({ cost }) => cost.memory_bytes)) / 2 ** 20)} MiB`],
    expectation(error),
  ]);
  const stages = Object.keys(found.levels[0].cost.stages);
  const levels = {
    caption: "What each mesh is predicted to take",
    head: ["mesh", "CPU s", ...stages.map((name) => `${name}, s`), "memory, MiB", "numerical, %", "plane, %", "method, %"],
    rows: found.levels.map(({ model, level, slices, cost, error: expected }) => [
      [model === choice.model ? "" : model, level, slices > 1 ? `${slices} slices` : ""].filter(Boolean).join(", "),
      number(cost.cpu_seconds, 2),
      ...stages.map((name) => number(cost.stages[name], 2)), String(Math.round(cost.memory_bytes / 2 ** 20)),
      percent(expected.numerical), expected.bias ? "bias" : percent(expected.plane), percent(expected.method),
    ]),
  };
  const said = [choice.reason, error.bias?.words, found.conflict].filter(Boolean).join("; ");
  const taken = (entry) => passes.some((own) => ["model", "level", "slices"].every((key) => entry[key] === own[key]));
  byId("plan").replaceChildren(
    ...found.warnings.map(({ message }) => make("p", { class: "alarm", role: "alert" }, `Warning: ${message}`)),
    head,
    make("p", { class: choice.met && !found.conflict ? "hint" : "alarm" }, `Mesh: ${choice.level}, ${said}.`),
  );
  byId("plan-tables").replaceChildren(
    folded("All meshes: what each is predicted to take", dataTable(levels, (row) => taken(found.levels[row]))),
    folded("Effect ledger: which physics is in, why, and its influence", dataTable(ledger(found.effect_ledger))),
  );
  return seconds;
}

/** The error that a run is expected to state, before it is begun: the largest over its loads. */
function expectation({ mean_um: mean, peak_to_peak_um: ripple, numerical, plane, bias }) {
  const of = (what, value, unit) => ({ text: `${number(value, 2)} ${unit}`, data: { "data-subject": `expected error of ${what}; most over all loads`, "data-value": value, "data-unit": unit } });
  if (ripple === null) {
    const worse = of("mean or peak to peak", 100 * Math.hypot(numerical, bias ? 0 : plane), "%");
    return ["expected error", worse.text, ["of mean or peak to peak, whichever is worse, over all loads"], worse.data];
  }
  const [first, second] = [of("peak to peak", ripple, "µm"), of("mean", mean, "µm")];
  return ["expected error, peak to peak", `± ${first.text}`, [{ ...second, text: `of the mean ± ${second.text}` }, "largest over all loads"], first.data];
}

function ledger(entries) {
  const text = (value) => (value === undefined || value === null ? "" : String(value));
  const words = (name) => name.replaceAll("_", " ");
  const shown = entries.filter(({ influence }) => !influence?.trifle);
  const trifles = entries.filter(({ influence }) => influence?.trifle).map(({ name }) => words(name));
  const { torque_n_m: torque, misalignment_um: skew } = entries.find(({ influence }) => influence)?.influence ?? {};
  const place = torque ? `at ${number(torque)} N m, misalignment ${number(skew)} µm` : "";
  const rows = shown.map((entry) => [
    words(entry.name), entry.on ? "yes" : "no", text(entry.reason), entry.influence?.words ?? "not estimated", text(entry.decision),
  ]);
  if (trifles.length) rows.push([`${trifles.length} below 0.1 %`, "", trifles.join(", "), "", ""]);
  return {
    caption: `Effect ledger; without an effect: change by leaving it out, estimated ${place}`,
    head: ["effect", "in this run", "because", "without it", "decision"],
    rows,
  };
}

/** @param {string} why */
export function noPlan(why) {
  byId("plan").replaceChildren(make("p", { class: "hint" }, why));
  byId("plan-tables").replaceChildren();
}
