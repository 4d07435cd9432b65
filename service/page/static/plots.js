/** Plots by plotly.js: in the colors of the page, with their numbers beside them. */

import { patiently } from "./api.js";
import { button, csv, dataTable, folded, make, save } from "./elements.js";
import { lines, rangeOf } from "./lines.js";
import { plotly } from "./plotly.js";
import { same } from "./schema.js";

const DARK = window.matchMedia("(prefers-color-scheme: dark)");
const NARROW = window.matchMedia("(max-width: 40rem)"); // also a wide screen that is zoomed
const NARROW_LINE = 36; // characters
const NARROW_LABEL = 72; // pixels beside a plot
const EDGE = 0.02; // of an axis beyond its ends
// without the bar of buttons: a plot is an image to a screen reader, and an image holds no controls
const CONFIG = { displaylogo: false, displayModeBar: false };
const OF_PAIR = "#ripple, #flank, #load, #orders, #sound > .live"; // plots of the pair that is designed
const shown = new Map();
/** @type {Record<string, number>} */
let marks = {}; // the complaint, by the labels of axes

function channels(color) {
  return [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16) / 255);
}

function luminance(color) {
  const [r, g, b] = channels(color).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/** A color that stays legible on dark paper: what is too dark has its lightness turned over. */
export function onDark(color) {
  if (!/^#[0-9a-f]{6}([0-9a-f]{2})?$/i.test(color) || luminance(color) > 0.16) return color;
  const rgb = channels(color);
  const shift = 1 - Math.max(...rgb) - Math.min(...rgb);
  return `#${rgb.map((c) => Math.round(255 * Math.min(Math.max(c + shift, 0), 1)).toString(16).padStart(2, "0")).join("")}${color.slice(7)}`;
}

function recolored(value) {
  if (Array.isArray(value)) return value.map(recolored);
  if (typeof value === "string") {
    if (value === "rgba(255,255,255,0.8)") return "rgba(20,24,29,0.8)";
    return onDark(value);
  }
  return value;
}

/** Colors in a trace or a layout, turned for dark paper; scales of maps stay. */
function darkened(content) {
  if (Array.isArray(content)) return content.map((item) => (typeof item === "object" && item ? darkened(item) : item));
  return Object.fromEntries(Object.entries(content).map(([key, value]) => {
    if (key === "colorscale") return [key, value];
    if (/color$/.test(key)) return [key, recolored(value)];
    return [key, value && typeof value === "object" && !["x", "y", "z"].includes(key) ? darkened(value) : value];
  }));
}

/** Mark values on all axes with such labels, in every plot of the pair. @param {Record<string, number>} values */
export function mark(values) {
  if (same(values, marks)) return;
  marks = values;
  redraw(OF_PAIR);
  document.dispatchEvent(new Event("marked"));
}

/** The value of the complaint on an axis; none where its plot does not reach it. */
export const markOn = (label, low, high) => (marks[label] >= low && marks[label] <= high ? marks[label] : null);

const ACROSS = { x: { x0: 0, x1: 1 }, y: { y0: 0, y1: 1 } };

/** A figure with a line where an axis has the complaint; one that came with marks of its own keeps those. */
export function marked(figure) {
  const { data, layout } = figure;
  if (layout.annotations?.some(({ text }) => text?.startsWith("complaint"))) return figure;
  let label = ""; // of the panel below, where an axis repeats it
  const line = ([key, axis]) => {
    const [, letter, number] = key.match(/^([xy])axis(\d*)$/) ?? [];
    if (!letter) return [];
    const own = axis.title?.text || (letter === "x" ? label : "");
    if (letter === "x") label = own;
    if (!(own in marks)) return [];
    const other = letter === "x" ? "y" : "x";
    const traces = data.filter((trace) => (trace[`${letter}axis`] ?? letter) === letter + number);
    const [low, high] = axis.range?.map((end) => (axis.type === "log" ? 10 ** end : end)) ?? rangeOf(traces.map((trace) => trace[letter] ?? []));
    const value = markOn(own, low - EDGE * (high - low), high + EDGE * (high - low));
    if (value === null) return [];
    const xanchor = letter === "x" && value < 0.5 * (low + high) ? "left" : "right"; // within the plot
    return [{
      type: "line", [`${letter}ref`]: letter + number, [`${letter}0`]: value, [`${letter}1`]: value, [`${other}ref`]: `${axis.anchor ?? other} domain`,
      ...ACROSS[other], line: { color: "#59636E", dash: "dash", width: 1.5 }, label: { text: "complaint", textposition: "end", textangle: 0, font: { size: 12 }, xanchor },
    }];
  };
  return { ...figure, layout: { ...layout, shapes: [...(layout.shapes ?? []), ...Object.entries(layout).reverse().flatMap(line)] } };
}

/** A figure as a plot shows it. */
const seen = (node) => themed(node.closest(OF_PAIR) ? marked(shown.get(node)) : shown.get(node));

function themed({ data, layout }) {
  const paper = { paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)" };
  if (!DARK.matches) return { data, layout: { ...layout, ...paper } };
  const dark = darkened(layout);
  for (const [name, axis] of Object.entries(dark)) {
    if (/^[xy]axis/.test(name)) Object.assign(axis, { gridcolor: "#333b44", linecolor: "#77818c", tickcolor: "#77818c" });
  }
  const ink = { font: { ...layout.font, color: "#e6e9ed" }, hoverlabel: { font: { color: "#14181d" } } };
  return { data: data.map(darkened), layout: { ...dark, ...paper, ...ink } };
}

/** A title in lines that a narrow screen has room for. */
function wrapped(text) {
  if (text.replace(/<.*?>/g, "").length <= NARROW_LINE) return text;
  const at = text.lastIndexOf(" ", NARROW_LINE);
  return at < 0 ? text : `${text.slice(0, at)}<br>${wrapped(text.slice(at + 1))}`;
}

/** Let the legend, the titles and the labels fit a narrow screen: a label at a line keeps its name alone. */
function fitted({ data, layout }, width) {
  if (width > 560) return { data, layout };
  const r = layout.annotations?.some((one) => one.showarrow) ? Math.min(layout.margin.r, NARROW_LABEL) : Math.min(layout.margin.r, 8);
  const narrow = { ...layout, font: { ...layout.font, size: 11 }, margin: { ...layout.margin, l: Math.min(layout.margin.l, 52), r } };
  for (const [name, axis] of Object.entries(narrow)) {
    if (/^[xy]axis/.test(name) && axis.title) {
      narrow[name] = { ...axis, title: { ...axis.title, text: axis.title.text.replace(/ \(.*/, ""), font: { size: 11 } } };
    }
  }
  narrow.annotations = layout.annotations?.map((one) => ({ ...one, text: one.showarrow ? one.text.split(":")[0] : wrapped(one.text) }));
  return { data, layout: narrow };
}

/** Let go of plots that have left the page: what plotly.js ties to the window holds them, their data and their listeners. */
async function swept() {
  for (const old of [...shown.keys()].filter(({ isConnected, dataset }) => !isConnected && (dataset.drawn || dataset.placed))) {
    shown.delete(old);
    sizes.unobserve(old);
    if (old.data) (await plotly()).purge(old);
  }
}

/** Until the browser has drawn what the page holds now; in a tab that nobody sees nothing is drawn. */
export const painted = () => new Promise((done) => {
  if (document.hidden) setTimeout(done);
  else requestAnimationFrame(() => setTimeout(done));
});

/** Draw or redraw a figure {data, layout} in a node. */
export async function plot(node, figure) {
  await swept();
  shown.set(node, figure);
  if (node.isConnected) node.dataset.placed = "yes"; // also in a tab that nobody opens, where it is not drawn
  sizes.observe(node);
  if (node.clientWidth) await draw(node, figure);
}

/** Draw every plot that comes into sight or changes its size; what nobody sees is not drawn. */
const sizes = new ResizeObserver((entries) => {
  for (const { target, contentRect } of entries) {
    if (!contentRect.width) delete target.dataset.size; // it may change unseen
    const size = `${Math.round(contentRect.width)} ${Math.round(contentRect.height)}`;
    if (contentRect.width && shown.has(target) && size !== target.dataset.size) draw(target, shown.get(target));
  }
});

async function draw(node, figure) {
  if (figure.layout.height) node.style.height = `${figure.layout.height}px`; // others take the height of their place
  const size = `${node.clientWidth} ${node.clientHeight}`;
  const resized = node.dataset.drawn && node.dataset.size !== size;
  node.dataset.size = size;
  const { data, layout } = fitted(seen(node), node.clientWidth || 800);
  if (figure.still) lines(node, { data, layout });
  else {
    node.querySelector(":scope > .lines")?.remove();
    const library = await patiently(plotly);
    await library.react(node, data, layout, CONFIG);
    if (resized && node.clientWidth) await library.Plots.resize(node); // react keeps the size of the first drawing
  }
  node.dataset.drawn = "yes";
}

/** Draw again what is in sight. @param {string} [part] of the page */
function redraw(part = "*") {
  for (const [node, figure] of [...shown]) if (node.clientWidth && node.closest(part)) draw(node, figure);
}

for (const query of [DARK, NARROW]) query.addEventListener("change", () => redraw());

async function savePng(node, name) {
  const { data, layout } = seen(node);
  const paper = DARK.matches ? "#14181d" : "#ffffff";
  const size = { width: Math.max(node.clientWidth, 900), height: layout.height || node.clientHeight };
  const url = await (await plotly()).toImage({ data, layout: { ...layout, paper_bgcolor: paper } }, { format: "png", scale: 2, ...size });
  save(await (await imageOf(url)), `${name}.png`, "image/png");
}

/** Bytes behind a data URL, without fetching it. */
function imageOf(url) {
  const bytes = atob(url.split(",")[1]);
  return new Blob([Uint8Array.from(bytes, (letter) => letter.charCodeAt(0))], { type: "image/png" });
}

/** The characters of a text of a plot, which plotly.js takes for HTML. */
const plain = (text) => text.replaceAll("&lt;", "<").replaceAll("&gt;", ">").replaceAll("&amp;", "&");

/** The columns of all curves, named by curve and axis; the edges of error bands are left out. */
function columnsOf({ data, layout }) {
  const label = (axis, letter) => plain(layout[`${letter}axis${(axis ?? letter).slice(1)}`]?.title?.text || letter);
  const curves = data.filter((trace) => trace.hoverinfo !== "skip" && (trace.x?.length > 1 || trace.z));
  return curves.flatMap((trace, k) => {
    const name = plain(trace.name || "") || trace.type || `curve ${k + 1}`;
    if (!trace.z) return ["x", "y"].map((letter) => [`${name}, ${label(trace[`${letter}axis`], letter)}`, trace[letter]]);
    const rows = trace.z.map((row, r) => [`${name}, y = ${trace.y[r]}`, row]);
    return [[`${name}, x`, trace.x], ...rows];
  });
}

/** A plot with its words, its numbers and its files. */
export function figureBlock(figure, level = "h4") {
  const label = `${figure.title}. ${figure.alternative}`;
  const node = make("div", { class: "plot", role: "img", "aria-label": label });
  const tool = (text, action) => button(text, action, { class: "small", "data-tool": text, "aria-label": `${text} of: ${figure.title}` });
  const tools = make(
    "div", { class: "plot-tools" },
    tool("PNG", () => savePng(node, figure.key)),
    tool("CSV", () => save(csv(columnsOf(shown.get(node))), `${figure.key}.csv`, "text/csv")),
    tool("JSON", () => save(JSON.stringify(shown.get(node)), `${figure.key}.json`, "application/json")),
  );
  const block = make(
    "figure", { "data-figure": figure.key }, make(level, {}, figure.title), node, tools,
    make("figcaption", {}, make("strong", {}, figure.alternative), ` ${figure.caption}`),
    figure.table ? folded("Numbers", dataTable(figure.table)) : null,
  );
  return { block, node };
}
