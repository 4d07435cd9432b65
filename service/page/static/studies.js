/** Jobs on the pair beside its analysis: a card for each process of the service that studies a case. */

import { get, patiently } from "./api.js";
import { card } from "./card.js";
import { byId, make } from "./elements.js";
import { showReport } from "./report.js";

const TABS = { optimize: "ripple", sweep: "ripple", flank: "flank", "root-stress": "load", ablate: "errors", frontier: "errors" };

/** The studies of a case among the processes of a service. */
export function studiesOf(processes) {
  return processes.map(cardOf).filter(({ action, subjects = [] }) => action && subjects.includes("case"));
}

/** What a process says for its card. */
function cardOf({ id, title, description, additionalParameters }) {
  const { action = [], subjects, fields = [{}] } = Object.fromEntries(additionalParameters.parameters.map(({ name, value }) => [name, value]));
  return { process: id, title, text: description, action: action[0], subjects, fields: Object.entries(fields[0]).map(fieldOf) };
}

/** A field of a card, by the schema of the input. */
function fieldOf([name, schema]) {
  const kind = schema.anyOf?.find(({ type }) => type !== "null") ?? schema;
  const list = kind.type === "array";
  const value = list ? (schema.default ?? []).join(", ") : String(schema.default ?? "");
  return { name, label: schema.title, value, list, ...(kind.enum ? { choices: kind.enum.map((choice) => [choice, choice.replaceAll("_", " ")]) } : {}) };
}

/** Show an optimization; `take` is given its flanks. */
async function showOptimization(target, reference, { take, signal }) {
  const found = await patiently(() => get(reference.href));
  if (!(await showReport(target, reference, { making: true, signal }))) return;
  for (const part of target.querySelectorAll(":scope > details")) part.open = true; // the design and its scatter
  const button = make("button", { type: "button", onclick: () => take(found.optimum.values) }, "Take the optimum into the case");
  target.querySelector(".headline").after(make("div", { class: "row" }, button));
}

/** Show a result of any kind but a table; `take` is given the flanks of an optimization. */
export async function showResult(target, reference, { take, signal }) {
  if (reference.kind === "optimization") await showOptimization(target, reference, { take, signal });
  else await showReport(target, reference, { signal });
}

/**
 * Offer the studies of the pair as typed.
 * @param {ReturnType<typeof studiesOf>} studies
 * @param {{design: import("./design.js").Design, slot: Function, show: Function}} page
 */
export function showStudies(studies, { design, slot, show }) {
  for (const study of studies) {
    const { process } = study;
    byId(TABS[process] ?? "tolerance").append(
      card(study, (parts) => slot(process, parts, show), (values) => ({ process, inputs: { case: design.case, ...values } })),
    );
  }
}
