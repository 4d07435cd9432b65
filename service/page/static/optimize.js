/** Flanks of least expected peak-to-peak, searched by the service: what is varied, and the optimum taken over. */

import { get, patiently } from "./api.js";
import { make } from "./elements.js";
import { showReport } from "./report.js";

/**
 * Inputs of the process: tip relief of both gears is free, crowning too where the case is computed over the face.
 * @param {object} content the case
 * @param {{relief_um: number, scatter_um?: number, evaluations?: number}} wish largest relief,
 *   standard deviation of the misalignment, most designs
 */
export function optimizationOf(content, wish) {
  const module = content.pair.normal_module_mm;
  const relief = { tip_relief_um: [0, wish.relief_um], tip_relief_length_mm: [0.15 * module, 0.8 * module] };
  const plane = /^plane/.test(content.accuracy?.model ?? "");
  const pinion = plane ? relief : { ...relief, helix_crowning_um: [0, 30] };
  const asked = { case: content, variables: { pinion, wheel: relief }, search: { evaluations: wish.evaluations ?? 1000 } };
  return wish.scatter_um > 0 && !plane ? { ...asked, scatter: { misalignment_um: wish.scatter_um } } : asked;
}

/** Show an optimization; `take` is given its flanks. */
export async function showOptimization(target, reference, { take, signal }) {
  const found = await patiently(() => get(reference.href));
  if (!(await showReport(target, reference, { making: true, signal }))) return;
  for (const part of target.querySelectorAll(":scope > details")) part.open = true; // the design and its scatter
  const button = make("button", { type: "button", onclick: () => take(found.optimum.values) }, "Take the optimum into the case");
  target.querySelector(".headline").after(make("div", { class: "row" }, button));
}
