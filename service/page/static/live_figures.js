/** The plots of the live flanks: curves, harmonics and load sharing, several results on one pair of axes. */

import { rangeOf } from "./lines.js";

const PAIRS = [ // by index, as in the report (drawing/palette.py)
  "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9",
];
export const SHOWN_HARMONICS = 8;
const [STRONGEST, LABELED, HIGHEST] = [60, 16, 4.2]; // lines drawn and named, mesh order
const BELOW = "#B4BBC3"; // what is below its error
const APART = 0.09; // mesh orders between names
const [PARTS, ROOM] = [8, 0.4]; // of an axis: steps of the grid that it ends on at least, steps beyond its values

/**
 * @typedef {{name: string, pair: string, curve: any, color: string, width: number, dash: string}} Shown a curve of a pair as it is drawn
 */

/** Positions and values over two pitches (or the whole longer period), closed. */
export function over(curve, values) {
  const turns = curve.period === 1 ? [0, 1] : [0];
  const x = turns.flatMap((turn) => curve.position.map((place) => place + turn * curve.period));
  const y = turns.flatMap(() => values);
  return { x: [...x, curve.position[0] + turns.length * curve.period], y: [...y, values[0]] };
}

export function layout(x, y, more = {}) {
  const axis = (text) => ({
    title: { text, standoff: 8, font: { size: 13 } }, gridcolor: "#DDE1E6", linecolor: "#59636E", zeroline: false, ticks: "outside",
    tickcolor: "#59636E", automargin: true,
  });
  return {
    font: { family: "system-ui, -apple-system, 'Segoe UI', 'Liberation Sans', sans-serif", size: 13, color: "#1B1F24" }, margin: { l: 60, r: 12, t: 28, b: 44 }, xaxis: axis(x), yaxis: axis(y),
    legend: { orientation: "h", x: 0, y: 1, yref: "container", yanchor: "top" }, hovermode: "x unified", ...more,
  };
}

/** Ends of an axis on a coarse grid, so that it stands while a slider moves: plotly.js keeps every label by its place. @param {number[][]} rows */
export function endsOf(rows) {
  const ends = rangeOf(rows);
  const step = 2 ** Math.floor(Math.log2(ends[1] - ends[0] || 1)) / PARTS;
  return ends.map((end, k) => end && step * (k ? Math.ceil(end / step + ROOM) : Math.floor(end / step - ROOM)));
}

/**
 * Curves less their means: designs of unlike stiffness would else lie apart, their ripples flat.
 * @param {Shown[]} shown @param {any[]} bands behind them
 */
export function steFigure(shown, bands) {
  const curves = shown.map(({ name, curve, color, width, dash }) => ({
    ...over(curve, curve.ste_um.map((value) => value - curve.mean_um)), type: "scatter", mode: "lines", name,
    line: { color, width, dash },
  }));
  const data = [...bands, ...curves];
  const made = layout("position, base pitches", "STE less mean, µm");
  made.yaxis.range = endsOf(data.map(({ y }) => y));
  return { data, layout: made };
}

/** The strongest orders of a curve up to the fourth of the mesh, by name: of the mesh, of a shaft, or beside the mesh. @param {any} curve */
export function strongestOrders({ order, order_name: names, amplitude_um: amplitudes, amplitude_error_um: errors }, most = STRONGEST) {
  const lines = order.map((at, k) => ({ order: at, name: names[k], amplitude: amplitudes[k], error: errors?.[k] ?? null })).filter((line) => line.order < HIGHEST);
  return lines.sort((one, other) => other.amplitude - one.amplitude).slice(0, most);
}

/** What stands at lines, the strongest first: a line beside a stronger one is named at that one, "mesh 1 (± pinion 1)". */
function labelsOf(lines) {
  const beside = (line, other) => Math.abs(line.order - other.order) < APART;
  return lines.map((line, rank) => {
    if (lines.slice(0, rank).some((other) => beside(line, other))) return "";
    const sides = lines.filter(({ name }) => name.startsWith(`${line.name} `)).map(({ name }) => name.slice(line.name.length + 3));
    return [line.name, ...new Set(sides.map((side) => `± ${side}`))].join(" ");
  });
}

/** Orders of teeth that differ: mesh, shafts, sidebands and ghost orders, named at their lines. @param {Shown[]} shown */
function ordersFigure(shown) {
  const data = shown.map(({ name, curve, color }, k) => {
    const lines = curve.period > 1 ? strongestOrders(curve) : curve.harmonics_um.slice(0, 4).map((amplitude, at) => (
      { order: at + 1, name: `mesh ${at + 1}`, amplitude, error: curve.harmonics_error_um?.[at] ?? null }));
    const labels = k === shown.length - 1 ? labelsOf(lines.slice(0, LABELED)) : [];
    return {
      type: "bar", name, x: lines.map((line) => line.order), y: lines.map(({ amplitude }) => amplitude), width: 0.02, marker: { color: lines.map(({ amplitude, error }) => (error >= amplitude ? BELOW : color)) },
      text: labels, textposition: "outside", textangle: -90, constraintext: "none", cliponaxis: false, customdata: lines.map((line) => line.name),
      hovertemplate: "%{customdata}: %{y:.3g} µm",
    };
  });
  const top = Math.ceil(PARTS * Math.log10(Math.max(...data.flatMap(({ y }) => y)))) / PARTS;
  const made = layout("order of the mesh", "amplitude, µm", { barmode: "overlay", hovermode: "closest" });
  Object.assign(made.yaxis, { type: "log", range: [top - 3.5, top + 1.2], dtick: 1 });
  Object.assign(made.xaxis, { range: [-0.05, HIGHEST], dtick: 1 });
  return { data, layout: made };
}

/** @param {Shown[]} shown @param {number} count of harmonics */
export function harmonicsFigure(shown, count) {
  if (shown.at(-1).curve.period > 1) return ordersFigure(shown);
  const order = Array.from({ length: count }, (_, k) => k + 1);
  const data = shown.map(({ name, curve, color }) => {
    const [y, errors] = [curve.harmonics_um, curve.harmonics_error_um ?? []].map((values) => values.slice(0, count));
    const band = errors.length ? { error_y: { type: "data", array: errors, color: "#1B1F24", thickness: 1, width: 3 } } : {};
    return { type: "bar", name, x: order, y, marker: { color: y.map((value, k) => (errors[k] >= value ? BELOW : color)) }, ...band };
  });
  const made = layout("harmonic of the mesh", "amplitude, µm", { bargap: 0.25 });
  made.xaxis.dtick = 1;
  made.yaxis.range = endsOf([[0], ...data.map(({ y, error_y: band }) => y.map((value, k) => value + (band?.array[k] ?? 0)))]);
  return { data, layout: made };
}

/** The share of one pair of teeth as it moves on: with every base pitch it is one pair further ahead. */
function shareOf(curve, pair) {
  const column = (turn) => curve.pair.indexOf(pair + turn);
  const at = (row, turn) => (column(turn) < 0 ? 0 : row[column(turn)]);
  const turns = [0, 1];
  const x = turns.flatMap((turn) => curve.position.map((place) => place + turn));
  const y = turns.flatMap((turn) => curve.load_share.map((row) => at(row, turn)));
  return { x: [...x, 2], y: [...y, at(curve.load_share[0], 2)] };
}

export function sharingFigure(now) {
  const wanted = now.period === 1 ? [now.pair[0] - 1, ...now.pair] : now.pair;
  const lines = wanted.map((pair) => [pair, now.period === 1
    ? shareOf(now, pair) : over(now, now.load_share.map((row) => row[now.pair.indexOf(pair)]))]);
  const data = lines.filter(([, line]) => Math.max(...line.y) > 1e-6).map(([pair, line]) => ({
    ...line, y: line.y.map((share) => (share > 1e-9 ? share : null)), type: "scatter", mode: "lines", name: `pair ${pair > 0 ? "+" : ""}${pair}`,
    line: { color: PAIRS[((-pair % PAIRS.length) + PAIRS.length) % PAIRS.length], width: 2 },
  }));
  const made = layout("position, base pitches", "load share");
  made.yaxis.range = [-0.02, 1.05];
  return { data, layout: made };
}
