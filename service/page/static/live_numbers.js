/** The numbers of the live curves: main figures with error and change, and all of them as a table. */

import { bandOf, changeOf, estimate, level } from "./digits.js";
import { number } from "./elements.js";
import { strongestOrders } from "./live_figures.js";

/** @typedef {import("./live_figures.js").Shown} Shown */
/** @typedef {import("./digits.js").Printed} Printed */

/** A torque as it is typed. @param {number} torque */
export const torqueWords = (torque) => `${Number(torque.toPrecision(4))} N m`;

/** At which torque and misalignment a curve is. @param {any} curve */
export function pointWords({ torque_n_m: torque, misalignment_um: misaligned }) {
  return `at ${torqueWords(torque)}${misaligned ? `, misaligned by ${Number(misaligned.toPrecision(4))} µm` : ""}`;
}

/** Of what a number is: figure, pair, design, operating point. @param {string} what @param {Shown} shown */
const subjectOf = (what, { pair, name, curve }) => [what, pair, name, pointWords(curve)].join("; ");

const unstated = () => null;
const figure = (what, unit, value, error, size = false) => (shown) => ({
  subject: subjectOf(what, shown), value: value(shown.curve) ?? NaN, error: error(shown.curve), unit, coming: shown.curve.preview && error !== unstated, size,
});
const ripple = figure("peak to peak", "µm", (curve) => curve.peak_to_peak_um, (curve) => curve.peak_to_peak_error_um);
const mean = figure("mean", "µm", (curve) => curve.mean_um, (curve) => curve.mean_error_um);
const harmonic = (count) => figure(`harmonic ${count}`, "µm", (curve) => curve.harmonics_um[count - 1], (curve) => curve.harmonics_error_um?.[count - 1], true);
const pressure = figure("largest pressure", "MPa", ({ flanks }) => flanks.largest_pressure_mpa, unstated);
const edges = (shown) => ({ ...figure("pressure at the edges", "MPa", ({ flanks }) => flanks.edge_pressure_mpa, unstated)(shown), rough: true });
const faceLoad = figure("K_Hbeta", "", ({ flanks }) => flanks.k_h_beta, unstated);
const bias = figure("bias of the mean", "%", (curve) => 100 * curve.bias.mean, unstated);
const OVER_FACE = [
  ["mean over the face", figure("mean over the face", "µm", (curve) => curve.mean_over_face_um, (curve) => curve.mean_over_face_error_um)],
  ["peak to peak over the face", figure("peak to peak over the face", "µm", (curve) => curve.peak_to_peak_over_face_um, (curve) => curve.peak_to_peak_over_face_error_um)],
];

/** Error of a difference of two estimates, which are independent. */
const ofBoth = (one, other) => (Number.isFinite(one) && Number.isFinite(other) ? Math.hypot(one, other) : Math.min(one ?? NaN, other ?? NaN));

/** Relative change of a figure. @param {Shown} now @param {Shown} from @returns {Printed | ""} */
function change(now, from, of) {
  const [one, other] = [of(now), of(from)];
  if (!other.value || one.value === other.value) return "";
  const error = 100 * (ofBoth(one.error, other.error) / other.value);
  return changeOf({ ...one, subject: `change from ${from.name} of ${one.subject}`, value: 100 * (one.value / other.value - 1), error, unit: "%" });
}

/** Level of an amplitude, dB re 1 µm, and what its error makes of it: without end where that is as large. @param {Shown} shown @param {number} count @returns {import("./digits.js").Estimate} */
function levelOf(shown, count) {
  const { value, error, coming } = harmonic(count)(shown);
  return { subject: subjectOf(`level of harmonic ${count}`, shown), value: 20 * Math.log10(value), error: bandOf(value, error), unit: "dB", coming };
}

/** Change of the level of a harmonic; of one that falls below its error the least fall. @param {Shown} now @param {Shown} from @param {number} count @returns {Printed | ""} */
function levelChange(now, from, count) {
  const [one, other] = [levelOf(now, count), levelOf(from, count)];
  const given = { ...one, subject: `change from ${from.name} of ${one.subject}`, value: one.value - other.value, error: ofBoth(one.error, other.error) };
  if (![one.error, other.error].includes(Infinity)) return changeOf(given);
  const [after, before] = [now, from].map(harmonic(count));
  const least = 20 * Math.log10((before.value - before.error) / (after.value + after.error));
  return { text: least > 0 ? `below −${number(least, 2)} dB` : "within the errors", band: "", data: { "data-subject": given.subject, "data-below": true } };
}

/** A level as it is printed. @param {Shown} shown @param {number} count @returns {Printed} */
const levelIn = (shown, count) => level({ ...harmonic(count)(shown), subject: subjectOf(`level of harmonic ${count}`, shown) });

/** Pressure at edges, where the true one is singular, apart from that of the flank; nothing where no contact reaches one. */
export const edgeWords = ({ edge_pressure_mpa: edge }) => (edge ? `${number(edge, 3)} MPa` : "");

/** Values in the cells of a table, whose head has the unit. @param {Printed} made */
const cell = ({ text, band, data }, unit = "") => ({
  text: [unit ? text.replace(` ${unit}`, "") : text, band.startsWith("±") ? band.replace(" ", "\u00a0") : band && `(${band})`].filter(Boolean).join(" "), data });

/** What each source states of the errors of a curve. @param {Shown} shown */
export function sourcesOf(shown) {
  const named = (source) => source.replace("discretisation", "discretization").replaceAll("_", " ");
  const part = (source, what, value) => ({ text: number(value, 2), data: { "data-subject": subjectOf(`error of ${what} by ${source}`, shown), "data-value": value, "data-unit": "µm" } });
  const row = ([name, of]) => [named(name), part(name, "peak to peak", of.peak_to_peak), part(name, "mean", of.mean), part(name, "harmonic 1", of.first_harmonic)];
  const known = Object.entries(shown.curve.error_by_source_um).filter(([, of]) => Math.max(...Object.values(of)) > 1e-6); // less is rounding
  return { caption: "Errors by source, µm", head: ["source", "peak to peak", "mean", "harmonic 1"], rows: known.map(row) };
}

const heardWords = ({ harmonic: count, torque }) => `complaint, harmonic ${count} at ${torqueWords(torque)}`;

const changeWords = (text, from) => (text.startsWith("within") ? `change ${text}` : `${text.startsWith("no") ? "" : "change "}${text} from ${from}`);

/**
 * Level of the complaint's harmonic with its band, and its change from the curve that it is compared with.
 * @param {{harmonic: number, torque: number, curves: Shown[]} | null} heard the last is the one now
 */
export function heardFigures(heard) {
  if (!heard) return [];
  const { harmonic: count, curves } = heard;
  if (!curves.length) return [[heardWords(heard), "none", ["no curve at this torque: at most twice the highest of the result"]]];
  const { text, band, data } = levelIn(curves.at(-1), count);
  const changed = curves.length > 1 && levelChange(curves.at(-1), curves[0], count);
  const re = band.startsWith("±") || !band ? `${band} re 1 µm`.trim() : band;
  return [[heardWords(heard), text, [re, changed && { ...changed, text: changeWords(changed.text, curves[0].name) }], data]];
}

/** Remark on figures of the flanks: a live answer solves one discretization of them. */
const UNSTATED = "error not estimated";

/** Main figures of a curve, each with its error and its change from another. @param {Shown} now @param {Shown} from */
export function mainFigures(now, from) {
  const entry = (name, of, remarks = [], changed = change(now, from, of)) => {
    const { text, band, data } = estimate(of(now));
    return [name, text, [band, ...remarks, changed], data];
  };
  const { flanks, bias: biased } = now.curve;
  const atEdges = Boolean(flanks.edge_pressure_mpa);
  return [
    entry("peak to peak", ripple),
    entry("mean", mean),
    entry("first harmonic", harmonic(1), [], levelChange(now, from, 1)),
    entry("largest pressure", pressure, [atEdges && "on the flank", UNSTATED]),
    ...(atEdges ? [entry("at the edges", edges, ["indicative"], "")] : []),
    ...(flanks.k_h_beta === null ? [] : [entry("K_Hbeta", faceLoad, [UNSTATED])]),
    ...(biased ? [entry("bias of the mean", bias, [biased.words], ""), ...OVER_FACE.map(([name, of]) => entry(name, of))] : []),
  ];
}

/** Main figures of variants beside each other, with their errors; of tones the change from the first. @param {Shown[]} variants @param {any} heard */
export function besideFigures(variants, heard) {
  const named = (one, other) => one.name.localeCompare(other.name);
  const shown = [...variants].sort(named);
  const [first] = shown;
  const row = (name, of, unit = "") => [name, ...shown.map((own) => cell(estimate(of(own)), unit))];
  const differing = (name, count, all, unit = "dB") => [name, ...shown.map((own) => {
    const [at, from] = [all.find((each) => each.name === own.name), all[0]];
    const changed = at && at !== from && levelChange(at, from, count);
    return changed ? cell(changed, unit) : "";
  })];
  const heards = heard?.curves.length ? [...heard.curves].sort(named) : [];
  const heardOf = (own) => heards.find(({ name }) => name === own.name);
  const complaint = heard ? [
    [`${heardWords(heard)}${heards.length ? ", dB re 1 µm" : ""}`, ...shown.map((own) => (heardOf(own) ? cell(levelIn(heardOf(own), heard.harmonic), "dB") : "none"))],
    ...(heards.length ? [differing(`the same, dB from ${heards[0].name}`, heard.harmonic, heards)] : []),
  ] : [];
  const misaligned = shown.some(({ curve }) => curve.misalignment_um);
  return {
    caption: `Variants ${misaligned ? `at ${torqueWords(first.curve.torque_n_m)}` : pointWords(first.curve)}`,
    head: ["figure", ...shown.map(({ name }) => name)],
    rows: [
      ...complaint,
      ...(misaligned ? [["misaligned by, µm", ...shown.map(({ curve }) => number(curve.misalignment_um, 3))]] : []),
      row("peak to peak, µm", ripple, "µm"),
      row("first harmonic, µm", harmonic(1), "µm"),
      differing(`first harmonic, dB from ${first.name}`, 1, shown),
      row("mean, µm", mean, "µm"),
      row("largest pressure, MPa", pressure, "MPa"),
      ...(first.curve.flanks.k_h_beta === null ? [] : [["K_Hbeta", ...shown.map((own) => (own.curve.flanks.k_h_beta === null ? "none" : cell(estimate(faceLoad(own)))))]]),
      ...(first.curve.bias ? [["bias of the mean, %", ...shown.map((own) => (own.curve.bias ? cell(estimate(bias(own)), "%") : "none"))]] : []),
    ],
  };
}

/** Figures of every curve beside each other. @param {Shown[]} shown @param {number} count of harmonics */
export function numbersOf(shown, count) {
  const row = (name, of) => [name, ...shown.map((own) => cell(estimate(of(own)), "µm"))];
  const tones = Array.from({ length: count }, (_, k) => row(`harmonic ${k + 1}`, harmonic(k + 1)));
  return {
    caption: `Transmission error ${pointWords(shown.at(-1).curve)}, µm`,
    head: ["figure", ...shown.map(({ name }) => name)],
    rows: [row("peak to peak", ripple), row("mean", mean), ...tones],
  };
}

/** Peak to peak, mean and harmonics of a curve in words. @param {Shown} shown @param {number} count */
export function spokenFigures(shown, count) {
  const said = (of) => {
    const { text, band } = estimate(of(shown));
    return [text, band].filter(Boolean).join(" ");
  };
  return { ripple: said(ripple), mean: said(mean), harmonics: Array.from({ length: count }, (_, k) => said(harmonic(k + 1))).join(", ") };
}

/** The strongest orders of teeth that differ, by name. @param {Shown} shown */
export function ordersOf(shown) {
  const rows = strongestOrders(shown.curve, 20).map(({ order, name, amplitude, error }) => [
    name, number(order), cell(estimate({ subject: subjectOf(`order ${name}`, shown), value: amplitude, error, unit: "µm", size: true }), "µm")]);
  return { caption: `Strongest orders ${pointWords(shown.curve)}`, head: ["order", "of the mesh", "amplitude, µm"], rows };
}
