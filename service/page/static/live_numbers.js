/** The numbers of the live curves: main figures with error and change, and all of them as a table. */

import { bandOf, change, levelChange, plusMinus, toError } from "./digits.js";
import { number, signed } from "./elements.js";
import { strongestOrders } from "./live_figures.js";

/** Pressure at edges, where the true one is singular, apart from that of the flank; nothing where no contact reaches one. */
export const edgeWords = ({ edge_pressure_mpa: edge }) => (edge ? `${number(edge, 3)} MPa` : "");

/** What each source states of the errors of a curve. */
export function sourcesOf({ error_by_source_um: errors }) {
  const row = ([name, of]) => [name.replace("discretisation", "discretization").replaceAll("_", " "), ...["peak_to_peak", "mean", "first_harmonic"].map((figure) => number(of[figure], 2))];
  return { caption: "Errors by source, µm", head: ["source", "peak to peak", "mean", "harmonic 1"], rows: Object.entries(errors).map(row) };
}

/** Level of an amplitude, dB re 1 µm, and what its error makes of it: without end where that is as large. */
function levelOf({ harmonics_um: amplitudes, harmonics_error_um: errors, preview }, harmonic) {
  const [amplitude, error] = [amplitudes[harmonic - 1], errors?.[harmonic - 1]];
  const level = (size) => 20 * Math.log10(size);
  if (error >= amplitude) return { level: level(amplitude), band: Infinity, words: `below ${minus(level(error))} dB`, remark: "its error" };
  const band = bandOf(amplitude, error);
  const words = `${toError(level(amplitude), band).replace("-", "−")} dB`;
  return { level: level(amplitude), band, words, remark: [plusMinus(band, level(amplitude), preview), "re 1 µm"].filter(Boolean).join(" ") };
}

export const minus = (value) => value.toFixed(1).replace("-", "−");

/** Levels of the complaint's harmonic, each with its change from the first, whose band is that of both. @param {any} heard */
function levelsOf({ harmonic, curves }) {
  const [first, ...others] = curves.map(({ name, curve }) => ({ name, coming: curve.preview, ...levelOf(curve, harmonic) }));
  const changed = ({ level, band, coming }) => (
    levelChange(level - first.level, band + first.band, coming));
  return [{ ...first, change: "" }, ...others.map((own) => ({ ...own, change: changed(own) }))];
}

const heardWords = ({ harmonic, torque }) => `complaint, harmonic ${harmonic} at ${Number(torque.toPrecision(4))} N m`;

/**
 * Level of the complaint's harmonic with its band, and its change from the curve that it is compared with.
 * @param {{harmonic: number, torque: number, curves: import("./live_figures.js").Shown[]} | null} heard the last is the one now
 */
export function heardFigures(heard) {
  if (!heard) return [];
  if (!heard.curves.length) return [[heardWords(heard), "none", "no curve at this torque: at most twice the highest of the result"]];
  const levels = levelsOf(heard);
  const { words, remark, change } = levels.at(-1);
  const from = change.startsWith("within") ? `change ${change}` : change && `${change} dB from ${levels[0].name}`;
  return [[heardWords(heard), words, [remark, from].filter(Boolean).join("; ")]];
}

/** Change of the level of the first harmonic, with the band of both. @param {any} now @param {any} from */
function firstHarmonicChange(now, from) {
  const [level, first] = [now, from].map((curve) => levelOf(curve, 1));
  const words = levelChange(level.level - first.level, level.band + first.band, now.preview);
  return words && !words.startsWith("within") ? `${words} dB` : words;
}

/** Remark on figures of the flanks: a live answer solves one discretization of them. */
const UNSTATED = "error not estimated";

/** Main figures of a curve, each with its error and its change from another. */
export function mainFigures(now, from) {
  const remarks = (...words) => words.filter(Boolean).join("; ");
  const entry = (name, value, error, changed) => [name, `${toError(value, error)} µm`, remarks(plusMinus(error, value, now.preview), changed)];
  const edges = edgeWords(now.flanks);
  const { k_h_beta: factor, largest_pressure_mpa: pressure } = now.flanks;
  const entries = [
    entry("peak to peak", now.peak_to_peak_um, now.peak_to_peak_error_um, change(now.peak_to_peak_um, from.peak_to_peak_um)),
    entry("mean", now.mean_um, now.mean_error_um, change(now.mean_um, from.mean_um)),
    entry("first harmonic", now.harmonics_um[0], now.harmonics_error_um?.[0], firstHarmonicChange(now, from)),
    ["largest pressure", `${number(pressure, 3)} MPa`, remarks(edges && "on the flank", UNSTATED, change(pressure, from.flanks.largest_pressure_mpa))],
    ...(edges ? [["at the edges", edges, "indicative"]] : []),
  ];
  if (factor !== null) entries.push(["K_Hbeta", number(factor, 4), remarks(UNSTATED, change(factor, from.flanks.k_h_beta))]);
  if (!now.bias) return entries;
  return [
    ...entries,
    ["bias of the mean", `${signed(100 * now.bias.mean, 2)} %`, now.bias.words],
    entry("mean over the face", now.mean_over_face_um, now.mean_over_face_error_um, change(now.mean_over_face_um, from.mean_over_face_um)),
    entry(
      "peak to peak over the face", now.peak_to_peak_over_face_um, now.peak_to_peak_over_face_error_um,
      change(now.peak_to_peak_over_face_um, from.peak_to_peak_over_face_um),
    ),
  ];
}

/** Main figures of variants beside each other, with their errors; of tones the change from the first. @param {import("./live_figures.js").Shown[]} variants @param {any} heard */
export function besideFigures(variants, heard) {
  const named = (one, other) => one.name.localeCompare(other.name);
  const shown = [...variants].sort(named);
  const [{ name: first, curve: from }] = shown;
  const row = (name, of) => [name, ...shown.map(({ curve }) => of(curve))];
  const measured = (name, value, error) => row(name, (curve) => (
    `${toError(value(curve), error(curve))} ${plusMinus(error(curve), value(curve), curve.preview)}`.trim()));
  const levels = heard?.curves.length ? levelsOf({ ...heard, curves: [...heard.curves].sort(named) }) : [];
  const heardOf = (name, of) => [name, ...shown.map((own) => levels.filter((level) => level.name === own.name).map(of)[0] ?? "none")];
  const complaint = heard ? [
    heardOf(`${heardWords(heard)}${levels.length ? ", dB re 1 µm" : ""}`, ({ words, level, band, coming }) => (
      band === Infinity ? `${words.replace(" dB", "")} (its error)` : `${words.replace(" dB", "")} ${plusMinus(band, level, coming)}`.trim())),
    ...(levels.length ? [heardOf(`the same, dB from ${levels[0].name}`, ({ change }) => change)] : []),
  ] : [];
  return {
    caption: "Variants",
    head: ["figure", ...shown.map(({ name }) => name)],
    rows: [
      ...complaint,
      measured("peak to peak, µm", (curve) => curve.peak_to_peak_um, (curve) => curve.peak_to_peak_error_um),
      measured("first harmonic, µm", (curve) => curve.harmonics_um[0], (curve) => curve.harmonics_error_um?.[0]),
      row(`first harmonic, dB from ${first}`, (curve) => (curve === from ? "" : firstHarmonicChange(curve, from).replace(" dB", ""))),
      measured("mean, µm", (curve) => curve.mean_um, (curve) => curve.mean_error_um),
      row("largest pressure, MPa", ({ flanks }) => number(flanks.largest_pressure_mpa, 3)),
      ...(from.flanks.k_h_beta === null ? [] : [row("K_Hbeta", ({ flanks }) => (flanks.k_h_beta === null ? "none" : number(flanks.k_h_beta, 4)))]),
      ...(from.bias ? [row("bias of the mean, %", ({ bias }) => (bias ? signed(100 * bias.mean, 2) : "none"))] : []),
    ].map((cells) => cells.map((text) => text.replace("± ", "±\u00a0"))),
  };
}

/** Figures of every curve beside each other. @param {import("./live_figures.js").Shown[]} shown @param {number} count of harmonics */
export function numbersOf(shown, count) {
  const row = (name, of) => [name, ...shown.map(({ curve }) => number(of(curve), 4))];
  const tones = Array.from({ length: count }, (_, k) => row(`harmonic ${k + 1}`, (curve) => curve.harmonics_um[k] ?? NaN));
  return {
    caption: "Transmission error, µm",
    head: ["figure", ...shown.map(({ name }) => name)],
    rows: [row("peak to peak", (curve) => curve.peak_to_peak_um), row("mean", (curve) => curve.mean_um), ...tones],
  };
}

/** The strongest orders of teeth that differ, by name. @param {any} curve */
export function ordersOf(curve) {
  const rows = strongestOrders(curve, 20).map(({ order, name, amplitude }) => [name, number(order), number(amplitude, 3)]);
  return { caption: "Strongest orders", head: ["order", "of the mesh", "amplitude, µm"], rows };
}
