/** Plots by plotly.js: in the colors of the page, with their numbers beside them. */

import { patiently } from "./api.js";
import { button, csv, dataTable, folded, make, save } from "./elements.js";
import { lines } from "./lines.js";
import { plotly } from "./plotly.js";

const DARK = window.matchMedia("(prefers-color-scheme: dark)");
const NARROW = window.matchMedia("(max-width: 40rem)"); // also a wide screen that is zoomed
const NARROW_LINE = 36; // characters
const NARROW_LABEL = 72; // pixels beside a plot
// without the bar of buttons: a plot is an image to a screen reader, and an image holds no controls
const CONFIG = { displaylogo: false, displayModeBar: false };
const shown = new Map();

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
      const text = name.startsWith("x") ? axis.title.text.replace(/ \(.*/, "") : axis.title.text;
      narrow[name] = { ...axis, title: { ...axis.title, text, font: { size: 11 } } };
    }
  }
  narrow.annotations = layout.annotations?.map((one) => ({ ...one, text: one.showarrow ? one.text.split(":")[0] : wrapped(one.text) }));
  return { data, layout: narrow };
}

/** Let go of plots that have left the page: what plotly.js ties to the window holds them, their data and their listeners. */
async function swept() {
  for (const old of [...shown.keys()].filter((node) => !node.isConnected && node.dataset.drawn)) {
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
  const { data, layout } = fitted(themed(figure), node.clientWidth || 800);
  if (figure.still) lines(node, { data, layout });
  else {
    node.querySelector(":scope > .lines")?.remove();
    const library = await patiently(plotly);
    await library.react(node, data, layout, CONFIG);
    if (resized && node.clientWidth) await library.Plots.resize(node); // react keeps the size of the first drawing
  }
  node.dataset.drawn = "yes";
}

for (const query of [DARK, NARROW]) {
  query.addEventListener("change", () => {
    for (const [node, figure] of [...shown]) if (node.isConnected && node.clientWidth) draw(node, figure);
  });
}

async function savePng(node, name) {
  const { data, layout } = themed(shown.get(node));
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
