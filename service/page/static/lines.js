// @ts-check
/** Lines on one pair of axes as SVG, with bands and marks: pictures that need no plotly.js. */

import { draw } from "./elements.js";

const TICKS = 5;

/** Round values from a low to a high one. @param {number} low @param {number} high */
export function ticks(low, high) {
  const size = 10 ** Math.floor(Math.log10((high - low) / TICKS));
  const step = [1, 2, 5, 10].map((part) => part * size).find((part) => (high - low) / part <= TICKS);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(12)));
}

/** @param {number[][]} rows */
export function rangeOf(rows) {
  const all = rows.flat();
  return [Math.min(...all), Math.max(...all)];
}

/** A band between two lines, or lines with points at the ends of it, as a trace. @param {number[]} x @param {number[]} low @param {number[]} high @param {string} color */
export const band = (x, low, high, color) => ({
  x: [...x, ...x.toReversed()], y: [...high, ...low.toReversed()], type: "scatter", mode: "lines", fill: "toself", fillcolor: `${color}33`,
  line: { color, width: 0 }, hoverinfo: "skip", showlegend: false,
});

/** Draw lines, bands and marks in the place of a plot, which gives the axes. @param {HTMLElement} node @param {any} figure */
export function lines(node, { data, layout }) {
  const { clientWidth: width, clientHeight: height } = node;
  const { l, r, t, b } = layout.margin;
  const x = rangeOf(data.map((trace) => trace.x));
  const [low, high] = rangeOf(data.map((trace) => trace.y));
  const y = [low - 0.05 * (high - low), high + 0.05 * (high - low)];
  const right = (value) => l + ((width - l - r) * (value - x[0])) / (x[1] - x[0]);
  const up = (value) => height - b - ((height - t - b) * (value - y[0])) / (y[1] - y[0]);
  const [beside, anchor] = layout.yaxis.side === "right" ? [width - r + 6, "start"] : [l - 6, "end"];
  const svg = draw("svg", { width, height, class: "lines" });
  for (const value of ticks(x[0], x[1])) {
    svg.append(draw("path", { d: `M${right(value)} ${t}V${height - b}`, class: "grid" }));
    svg.append(draw("text", { x: right(value), y: height - b + 16, "text-anchor": "middle" }, String(value)));
  }
  for (const value of ticks(y[0], y[1])) {
    svg.append(draw("path", { d: `M${l} ${up(value)}H${width - r}`, class: "grid" }));
    svg.append(draw("text", { x: beside, y: up(value) + 4, "text-anchor": anchor }, String(value)));
  }
  svg.append(...data.map((trace) => drawn(trace, right, up)));
  svg.append(
    draw("text", { x: (l + width) / 2, y: height - 6, "text-anchor": "middle" }, layout.xaxis.title.text),
    draw("text", { x: 4, y: 15 }, layout.yaxis.title.text),
  );
  node.replaceChildren(svg);
}

/** A mark, a band or a line. @param {any} trace @param {(x: number) => number} right @param {(y: number) => number} up */
function drawn({ x, y, mode, marker, fill, fillcolor, line }, right, up) {
  if (mode === "markers") return draw("circle", { cx: right(x[0]), cy: up(y[0]), r: 4, class: "mark", fill: marker.color });
  const d = x.map((value, k) => `${k ? "L" : "M"}${right(value).toFixed(1)} ${up(y[k]).toFixed(1)}`).join("");
  if (fill) return draw("path", { d: `${d}Z`, class: "band", fill: fillcolor });
  const dashes = line.dash === "dash" ? { "stroke-dasharray": "6 4" } : {};
  return draw("path", { d, class: "line", stroke: line.color, "stroke-width": line.width, fill: "none", ...dashes });
}
