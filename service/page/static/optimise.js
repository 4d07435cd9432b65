/** Flanks of least expected peak-to-peak, searched by the service: what is varied, Harris maps before and after. */

import { get } from "./api.js";
import { dataTable, figures, make, number } from "./elements.js";
import { figureBlock, plot } from "./plots.js";

const MOST_CURVES = 8;

/**
 * Inputs of the process: tip relief of both gears is free, crowning too where the case is computed over the face.
 * @param {object} content the case
 * @param {{relief_um: number, scatter_um?: number}} wish largest relief, standard deviation of the misalignment
 */
export function optimisationOf(content, wish) {
  const module = content.pair.normal_module_mm;
  const relief = { tip_relief_um: [0, wish.relief_um], tip_relief_length_mm: [0.15 * module, 0.8 * module] };
  const plane = /^plane/.test(content.accuracy?.model ?? "");
  const pinion = plane ? relief : { ...relief, helix_crowning_um: [0, 30] };
  const asked = { case: content, variables: { pinion, wheel: relief } };
  return wish.scatter_um > 0 && !plane ? { ...asked, scatter: { misalignment_um: wish.scatter_um } } : asked;
}

/** Show an optimisation; `take` is given its flanks. */
export async function showOptimisation(target, reference, take) {
  const found = await get(reference.href);
  const head = make("dl", { class: "headline" });
  const band = (design) => `± ${number(design.objective_error_um, 2)} µm`;
  figures(head, [
    ["expected peak to peak before", `${number(found.start.objective_um, 3)} µm`, band(found.start)],
    ["after", `${number(found.optimum.objective_um, 3)} µm`, band(found.optimum)],
  ]);
  const blocks = [["before", found.start], ["after", found.optimum]].map(([name, design]) => harris(name, design, found));
  target.replaceChildren(
    make("p", {}, `${found.reason.replaceAll(" um", " µm")}.`), head, dataTable(designs(found)),
    make("div", { class: "row" }, make("button", {
      type: "button", onclick: () => take(found.optimum.values),
    }, "Take the optimum into the case")),
    make("div", { class: "live-pair even" }, ...blocks.map(({ block }) => block)),
  );
  for (const { node, figure } of blocks) await plot(node, figure);
}

function designs(found) {
  const rows = found.variables.map(({ name, bounds }) => {
    const [gear, field] = name.split(".").slice(-2);
    const of = (design) => number(design.values[gear][field], 3);
    return [`${gear}, ${field.replace(/_(um|mm)$/, "").replaceAll("_", " ")}, ${/_um$/.test(field) ? "µm" : "mm"}`,
      of(found.start), of(found.optimum), number(bounds[0], 3), number(bounds[1], 3)];
  });
  return { caption: "Flanks", head: ["variable", "before", "after", "least", "most"], rows };
}

/** Transmission error over position, a curve for each torque, on one axis before and after. */
function harris(name, design, found) {
  const { torque_n_m: torque, position, ste_um: ste } = design.harris_map;
  const step = Math.max(1, Math.ceil(torque.length / MOST_CURVES));
  const every = (_, k) => k % step === 0;
  const both = [found.start, found.optimum].flatMap((one) => one.harris_map.ste_um.filter(every).flat());
  const room = 0.04 * (Math.max(...both) - Math.min(...both));
  const shades = torque.filter(every).map((_, k, all) => `hsl(${210 + (150 * k) / all.length} 70% 50%)`);
  const end = Math.ceil(position.at(-1) + 1e-12);
  const data = torque.filter(every).map((value, k) => ({
    type: "scatter", mode: "lines", name: `${number(value, 3)} N m`, x: [...position, end],
    y: [...ste.filter(every)[k], ste.filter(every)[k][0]], line: { color: shades[k], width: 1.8 },
  }));
  const axis = (text) => ({ title: { text, font: { size: 13 } }, gridcolor: "#DDE1E6", zeroline: false, automargin: true });
  const layout = {
    height: 380, margin: { l: 56, r: 10, t: 60, b: 46 }, font: { size: 13, color: "#1B1F24" },
    xaxis: axis("position, base pitches"),
    yaxis: { ...axis("STE, µm"), range: [Math.min(...both) - room, Math.max(...both) + room] },
    legend: { orientation: "h", x: 0, y: 1, yref: "container", yanchor: "top" },
  };
  const figure = { data, layout };
  const ripple = Math.max(...ste.map((curve) => Math.max(...curve) - Math.min(...curve)));
  const made = figureBlock({
    key: `harris_${name}`, title: `Harris map ${name}`, caption: "Transmission error over position at every torque.",
    alternative: `Largest peak to peak over the torques ${number(ripple, 3)} µm.`, plot: figure,
  });
  return { ...made, figure };
}
