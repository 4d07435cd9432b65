/** The plots of what happens on the live flanks: pressure over the driving gear's flank, load over the face. */

import { number } from "./elements.js";
import { endsOf, layout } from "./live_figures.js";
import { edgeWords } from "./live_numbers.js";
import { figureBlock, plot } from "./plots.js";

const FACE = "face position, mm (0 = mid-face of the pinion)";
const ROLL = "roll length, mm (of the pinion)";
const ISOLINES = 6;
const [PRESSURE, LOAD] = ["Pressure over the driving gear's flank", "Load over the face"];

/** @typedef {import("./live_figures.js").Shown} Shown */

const largestOf = (rows) => Math.max(...rows.map((row) => Math.max(...row)));
const overFace = (flanks) => flanks.face_position_mm.length > 1;

/** A round step between isolines, so that there are at most six. */
function isolineStep(largest) {
  const size = 10 ** Math.floor(Math.log10(largest || 1));
  return size * [0.2, 0.5, 1, 2, 5].find((part) => largest / (part * size) <= ISOLINES + 1);
}

/** The pressure that passes over the flank as it is now: over face and roll length, in the plane along the profile. */
function pressureFigure(flanks) {
  const { face_position_mm: x, roll_length_mm: y, pressure_mpa: z } = flanks;
  if (!overFace(flanks)) {
    const line = { type: "scatter", mode: "lines", name: "pressure", x: y, y: z.map(([value]) => value), line: { color: "#0072B2", width: 2.4 } };
    return { data: [line], layout: layout(ROLL, "Hertz pressure, MPa") };
  }
  const largest = largestOf(z);
  const size = isolineStep(largest);
  const map = {
    type: "contour", x, y, z: z.map((row) => row.map((value) => (value > 0.01 * largest ? value : null))), zmin: 0, zmax: endsOf([[0, largest]])[1],
    colorscale: "Cividis", colorbar: { title: { text: "Hertz pressure, MPa", side: "right" }, thickness: 14, tick0: 0 }, line: { color: "#FFFFFF", width: 1 },
    contours: { coloring: "heatmap", start: size, end: 0.92 * largest, size, showlabels: true, labelfont: { size: 11, color: "#FFFFFF" } },
    hovertemplate: "face %{x:.3g} mm<br>roll length %{y:.3g} mm<br>%{z:.4g} MPa<extra></extra>",
  };
  return { data: [map], layout: layout(FACE, ROLL, { hovermode: "closest" }) };
}

/** Load over the face of every curve, and of the one now at its worst position too. @param {Shown[]} shown */
function faceLoadFigure(shown) {
  const line = (name, x, y, look) => ({ type: "scatter", mode: "lines", name, x, y, line: look });
  const means = shown.map(({ name, curve: { flanks }, color, width, dash }) => (
    line(`${name}, mean`, flanks.face_position_mm, flanks.mean_load_n_per_mm, { color, width, dash })));
  const { curve: { flanks }, name } = shown.at(-1);
  const worst = line(`${name}, worst position`, flanks.face_position_mm, flanks.worst_load_n_per_mm, { color: "#56B4E9", width: 1.5, dash: "solid" });
  const made = layout(FACE, "load per face width, N/mm");
  made.yaxis.range = endsOf([[0], ...shown.map(({ curve }) => curve.flanks.mean_load_n_per_mm), flanks.worst_load_n_per_mm]);
  return { data: [...means, worst], layout: made };
}

/** The place of a plot that is drawn again and again. @param {string} key @param {string} title @param {string} caption */
export const liveBlock = (key, title, caption) => (
  figureBlock({ key, title, caption, alternative: "", plot: { data: [], layout: {} } }, "h3"));

/** What the pressure and the face load are now, and what they were. */
export class LiveFlanks {
  constructor() {
    this.pressure = liveBlock("live_pressure", PRESSURE, "Hertz pressure that passes over each point, root below. At a tip edge the true pressure is singular. No error is stated.");
    this.load = liveBlock("live_face_load", LOAD, "All pairs together: averaged over the positions, whose largest over mean is K_Hbeta, and at the position of the largest load. No error is stated.");
    this.blocks = [this.pressure.block, this.load.block];
  }

  /** @param {Shown[]} shown @param {string} point */
  async draw(shown, point) {
    for (const [{ block }, title] of [[this.pressure, PRESSURE], [this.load, LOAD]]) block.querySelector("h3").textContent = `${title}, ${point}`;
    const now = shown.at(-1).curve.flanks;
    const facing = shown.filter(({ curve }) => overFace(curve.flanks));
    this.load.block.hidden = !overFace(now);
    const edges = edgeWords(now);
    const factor = now.k_h_beta === null ? "" : `K_Hbeta ${number(now.k_h_beta, 4)}, `;
    this.pressure.node.setAttribute("aria-label", `Pressure over the driving gear's flank: at most ${number(now.largest_pressure_mpa, 3)} MPa${edges && ` on the flank, ${edges} at the edges (indicative)`}.`);
    const load = now.worst_load_n_per_mm;
    this.load.node.setAttribute("aria-label", `Load over the face: ${factor}at most ${number(Math.max(...load), 3)} N/mm.`);
    await plot(this.pressure.node, pressureFigure(now));
    if (overFace(now)) await plot(this.load.node, faceLoadFigure(facing));
  }
}
