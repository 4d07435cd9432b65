/** Building blocks of the page: elements, tables, downloads, numbers. */

/** Make an element: attributes by name, `on...` as listeners, children as nodes or text. */
export function make(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/** A button. @param {string} text @param {(event: Event) => any} onclick @param {object} [facts] further attributes */
export const button = (text, onclick, facts = {}) => make("button", { type: "button", ...facts, onclick }, text);

const SVG = "http://www.w3.org/2000/svg";

/** Make an element of a drawing. @param {string} name @param {Record<string, string | number>} attributes @param {string} [text] */
export function draw(name, attributes, text) {
  const node = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, String(value));
  if (text !== undefined) node.textContent = text;
  return node;
}

export const byId = (id) => document.getElementById(id);

const NUMERIC = /^$|^(no change|within the errors|below )|^[-+−]?[\d.]+(e[-+]?\d+)?(\s(N m|µm|%|±\s.*))?$/;

/** A table of texts or printed numbers; its first column names the row, columns of numbers stand to the right. */
export function dataTable({ caption, head, rows }, marked = () => false) {
  const right = head.map((_, k) => rows.every((row) => NUMERIC.test(row[k].text ?? row[k])));
  const cell = (kind, content, k, more = {}) => make(kind, { class: right[k] ? "n" : null, ...more, ...content.data }, content.text ?? content);
  const table = make(
    "table", { class: "data" },
    make("caption", {}, caption),
    make("thead", {}, make("tr", {}, ...head.map((text, k) => cell("th", text, k, { scope: "col" })))),
    make("tbody", {}, ...rows.map((row, index) => make(
      "tr", { class: marked(index) ? "chosen" : null },
      ...row.map((text, k) => (k === 0 ? cell("th", text, k, { scope: "row" }) : cell("td", text, k))),
    ))),
  );
  return make("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": caption }, table);
}

export function folded(title, ...content) {
  return make("details", {}, make("summary", {}, title), ...content);
}

/** Names with their values and remarks: texts, or printed numbers; `data` is that of the value. */
export function figures(list, entries) {
  const remark = (parts) => parts.flatMap((part, k) => [k ? "; " : " ", typeof part === "string" ? part : make("span", part.data, part.text)]);
  list.replaceChildren(...entries.map(([name, value, remarks = [], data = {}]) => {
    const parts = [remarks].flat().filter(Boolean);
    return make("div", {}, make("dt", {}, name), make("dd", data, value, parts.length ? make("small", {}, ...remark(parts)) : null));
  }));
}

/** Hand a file to the browser. */
export function save(content, name, type) {
  const blob = content instanceof Blob ? content : new Blob([content], { type });
  const url = URL.createObjectURL(blob);
  const link = make("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/** Columns of any lengths as CSV; the first row names them. */
export function csv(columns) {
  const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const length = Math.max(0, ...columns.map(([, values]) => values.length));
  const lines = [columns.map(([name]) => quoted(name)).join(",")];
  for (let row = 0; row < length; row += 1) {
    lines.push(columns.map(([, values]) => (values[row] ?? "")).join(","));
  }
  return `${lines.join("\n")}\n`;
}

export function number(value, digits = 4) {
  if (!Number.isFinite(value)) return "none";
  if (value === 0) return "0";
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size >= 7) return value.toExponential(digits - 1);
  return value.toFixed(Math.max(digits - 1 - size, 0));
}

export const signed = (value, digits) => `${value < 0 ? "−" : "+"}${number(Math.abs(value), digits)}`;

export function duration(seconds) {
  if (seconds < 1) return "under a second";
  if (seconds < 90) return `${Math.round(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}
