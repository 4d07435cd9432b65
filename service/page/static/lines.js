// @ts-check
/** Lines on one pair of axes as SVG: the first picture of the page, before plotly.js is needed. */

import { draw } from "./elements.js";

const EDGE = { left: 60, right: 12, top: 26, bottom: 44 };
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
function rangeOf(rows) {
  const all = rows.flat();
  return [Math.min(...all), Math.max(...all)];
}

/** Draw lines {x, y, line} in the place of a plot. @param {HTMLElement} node @param {any} figure */
export function lines(node, { data, layout }) {
  const { clientWidth: width, clientHeight: height } = node;
  const x = rangeOf(data.map((trace) => trace.x));
  const [low, high] = rangeOf(data.map((trace) => trace.y));
  const y = [low - 0.05 * (high - low), high + 0.05 * (high - low)];
  const right = (value) => EDGE.left + ((width - EDGE.left - EDGE.right) * (value - x[0])) / (x[1] - x[0]);
  const up = (value) => height - EDGE.bottom - ((height - EDGE.top - EDGE.bottom) * (value - y[0])) / (y[1] - y[0]);
  const svg = draw("svg", { width, height, class: "lines" });
  for (const value of ticks(x[0], x[1])) {
    svg.append(draw("path", { d: `M${right(value)} ${EDGE.top}V${height - EDGE.bottom}`, class: "grid" }));
    svg.append(draw("text", { x: right(value), y: height - EDGE.bottom + 16, "text-anchor": "middle" }, String(value)));
  }
  for (const value of ticks(y[0], y[1])) {
    svg.append(draw("path", { d: `M${EDGE.left} ${up(value)}H${width - EDGE.right}`, class: "grid" }));
    svg.append(draw("text", { x: EDGE.left - 6, y: up(value) + 4, "text-anchor": "end" }, String(value)));
  }
  for (const { x: along, y: values, line } of data) {
    const d = along.map((value, k) => `${k ? "L" : "M"}${right(value).toFixed(1)} ${up(values[k]).toFixed(1)}`).join("");
    svg.append(draw("path", { d, class: "line", stroke: line.color, "stroke-width": line.width, fill: "none" }));
  }
  svg.append(
    draw("text", { x: (EDGE.left + width) / 2, y: height - 6, "text-anchor": "middle" }, layout.xaxis.title.text),
    draw("text", { x: 4, y: 15 }, layout.yaxis.title.text),
  );
  node.replaceChildren(svg);
}
