/** Flanks of least expected peak-to-peak, searched by the service: shown, and the optimum taken over. */

import { get, patiently } from "./api.js";
import { make } from "./elements.js";
import { showReport } from "./report.js";

/** Show an optimization; `take` is given its flanks. */
export async function showOptimization(target, reference, { take, signal }) {
  const found = await patiently(() => get(reference.href));
  if (!(await showReport(target, reference, { making: true, signal }))) return;
  for (const part of target.querySelectorAll(":scope > details")) part.open = true; // the design and its scatter
  const button = make("button", { type: "button", onclick: () => take(found.optimum.values) }, "Take the optimum into the case");
  target.querySelector(".headline").after(make("div", { class: "row" }, button));
}
