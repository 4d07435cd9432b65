/** An optimization: its report, and a button that puts its flanks into the case. */

import { get, patiently } from "./api.js";
import { button } from "./elements.js";
import { showReport } from "./report.js";

/** `take` is given its flanks. */
async function show(target, reference, { take, signal }) {
  const found = await patiently(() => get(reference.href));
  if (!(await showReport(target, reference, { making: true, signal }))) return;
  for (const part of target.querySelectorAll(":scope > details")) part.open = true; // the design and its scatter
  target.querySelector(".headline").after(button("Take the optimum into the case", () => take(found.optimum.values)));
}

export const optimization = { kind: "optimization", show };
