/** Jobs beside the analysis: a card for each process of the service that studies a case, and what came of any. */

import { card } from "./card.js";
import { byId, make } from "./elements.js";
import { optimization } from "./optimization.js";
import { showReport } from "./report.js";

const TABS = { optimize: "ripple", sweep: "ripple", flank: "flank", "root-stress": "load", ablate: "errors", frontier: "errors", complaint: "orders" };

/** Kinds of results that are shown with more than their report: a row each. */
const KINDS = [
  optimization,
];

/** The studies among the processes of a service, each as its card shows it. */
export function studiesOf(processes) {
  const facts = ({ additionalParameters: { parameters } }) => Object.fromEntries(parameters.map(({ name, value }) => [name, value]));
  return processes.map((process) => ({ process, ...facts(process) })).filter(({ action }) => action).map(
    ({ process: { id, title, description }, action: [action], subjects, fields: [fields] }) => (
      { process: id, title, text: description, action, subjects, fields }));
}

/** Show a result of any kind but a table; `take` is given the flanks of an optimization. */
export async function showResult(target, reference, { take, signal }) {
  const { show = showReport } = KINDS.find(({ kind }) => kind === reference.kind) ?? {};
  await show(target, reference, { take, signal });
}

/**
 * Offer the studies of the pair as typed.
 * @param {ReturnType<typeof studiesOf>} studies
 * @param {{design: import("./design.js").Design, slot: Function, show: Function}} page
 */
export function showStudies(studies, page) {
  for (const study of studies) {
    byId(TABS[study.process] ?? "tolerance").append(
      card(study, page, (values) => ({ inputs: () => ({ case: page.design.submitted(), ...values }) }), { more: [make("p", { class: "hint", id: `cost-${study.process}` })] }),
    );
  }
}
