/** The plan of a run: time, memory, error of every mesh, and the effect ledger, before anything starts. */

import { byId, dataTable, duration, figures, folded, make, number } from "./elements.js";

const percent = (share) => number(100 * share, 2);

/** @param {object} found answer of /v1/plans */
export function showPlan(found) {
  const head = make("dl", { class: "headline" });
  const { choice, prediction, error } = found;
  figures(head, [
    ["model", choice.model, choice.level],
    ["time", duration(prediction.cpu_seconds), "of one processor"],
    ["memory", `${Math.round(prediction.memory_bytes / 2 ** 20)} MiB`],
    ["expected error", `${percent(error.total)} %`, `of which the model ${percent(error.model)} %`],
  ]);
  const stages = Object.keys(found.levels[0].cost.stages);
  const levels = {
    caption: "What each mesh is predicted to take",
    head: ["mesh", "CPU s", ...stages.map((name) => `${name}, s`), "memory, MiB", "error, %"],
    rows: found.levels.map(({ level, slices, cost, error: expected }) => [
      slices > 1 ? `${level}, ${slices} slices` : level, number(cost.cpu_seconds, 2),
      ...stages.map((name) => number(cost.stages[name], 2)), String(Math.round(cost.memory_bytes / 2 ** 20)),
      percent(expected.total),
    ]),
  };
  const said = [choice.reason, found.conflict].filter(Boolean).join("; ");
  const chosen = found.levels.findIndex((entry) => entry.level === choice.level);
  byId("plan").replaceChildren(
    head,
    make("p", { class: choice.met && !found.conflict ? "hint" : "alarm" }, `Mesh ${choice.level}: ${said}.`),
    folded("All meshes", dataTable(levels, (row) => row === chosen)),
    folded("Effect ledger: which physics is in, why, and what it is worth", dataTable(ledger(found.effect_ledger))),
  );
  return prediction.cpu_seconds;
}

function ledger(entries) {
  const text = (value) => (value === undefined || value === null ? "" : String(value));
  return {
    caption: "Effect ledger",
    head: ["effect", "in this run", "because", "worth", "decision"],
    rows: entries.map((entry) => [
      entry.name.replaceAll("_", " "), entry.on ? "yes" : "no", text(entry.reason), text(entry.worth), text(entry.decision),
    ]),
  };
}

export function noPlan() {
  byId("plan").replaceChildren(make("p", { class: "hint" }, "No plan: the case has errors, listed above the form."));
}
