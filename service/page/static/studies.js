/** Jobs beside the analysis: a card for each process of the service that studies a case, and what came of any. */

import { get, patiently } from "./api.js";
import { card } from "./card.js";
import { button, byId, make } from "./elements.js";
import { showReport } from "./report.js";

const TABS = { optimize: "ripple", sweep: "ripple", flank: "flank", "root-stress": "load", ablate: "errors", frontier: "errors", complaint: "orders" };

/** The studies among the processes of a service, each as its card shows it. */
export function studiesOf(processes) {
  const facts = ({ additionalParameters: { parameters } }) => Object.fromEntries(parameters.map(({ name, value }) => [name, value]));
  return processes.map((process) => ({ process, ...facts(process) })).filter(({ action }) => action).map(
    ({ process: { id, title, description }, action: [action], subjects, fields: [fields] }) => (
      { process: id, title, text: description, action, subjects, fields }));
}

/** Show an optimization; `take` is given its flanks. */
async function showOptimization(target, reference, { take, signal }) {
  const found = await patiently(() => get(reference.href));
  if (!(await showReport(target, reference, { making: true, signal }))) return;
  for (const part of target.querySelectorAll(":scope > details")) part.open = true; // the design and its scatter
  const taken = button("Take the optimum into the case", () => take(found.optimum.values));
  target.querySelector(".headline").after(make("div", { class: "row" }, taken));
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
export function showStudies(studies, page) {
  for (const study of studies) {
    byId(TABS[study.process] ?? "tolerance").append(
      card(study, page, (values) => ({ inputs: () => ({ case: page.design.submitted(), ...values }) })),
    );
  }
}
