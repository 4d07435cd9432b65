/** The numbers of the live curves: main figures with error and change, and all of them as a table. */

import { number } from "./elements.js";
import { SHOWN_HARMONICS } from "./live_figures.js";

const plusMinus = (error) => (Number.isFinite(error) ? `± ${number(error, 2)}` : "");

function change(value, from) {
  if (!from) return "";
  return `${value >= from ? "+" : "−"}${number(Math.abs(100 * (value / from - 1)), 3)} %`;
}

/** Pressure at edges, apart from that of the flank; nothing where no contact reaches one. */
export function edgeWords({ edge_pressure_mpa: edge }) {
  return edge ? `up to ${number(edge, 4)} MPa at edges, indicative` : "";
}

/** Main figures of a curve, each with its error and its change from another. */
export function mainFigures(now, from) {
  const remarks = (...words) => words.filter(Boolean).join("; ");
  const entry = (name, value, error, other) => [name, `${number(value, 3)} µm`, remarks(plusMinus(error), change(value, other))];
  const { k_h_beta: factor, largest_pressure_mpa: pressure } = now.flanks;
  const entries = [
    entry("peak to peak", now.peak_to_peak_um, now.peak_to_peak_error_um, from.peak_to_peak_um),
    entry("mean", now.mean_um, now.mean_error_um, from.mean_um),
    entry("first harmonic", now.harmonics_um[0], now.harmonics_error_um?.[0], from.harmonics_um[0]),
    ["largest pressure", `${number(pressure, 4)} MPa`, remarks(edgeWords(now.flanks), change(pressure, from.flanks.largest_pressure_mpa))],
  ];
  return factor === null ? entries : [...entries, ["K_Hbeta", number(factor, 4), change(factor, from.flanks.k_h_beta)]];
}

/** Figures of every curve beside each other. @param {import("./live_figures.js").Shown[]} shown */
export function numbersOf(shown) {
  const row = (name, of) => [name, ...shown.map(({ curve }) => number(of(curve), 4))];
  const tones = Array.from({ length: SHOWN_HARMONICS }, (_, k) => row(`harmonic ${k + 1}`, (curve) => curve.harmonics_um[k] ?? NaN));
  return {
    caption: "Transmission error, µm",
    head: ["figure", ...shown.map(({ name }) => name)],
    rows: [row("peak to peak", (curve) => curve.peak_to_peak_um), row("mean", (curve) => curve.mean_um), ...tones],
  };
}
