/** One field of the form: its control by the schema, its words and unit, its fault. */

import { make } from "./elements.js";
import { kindOf, same } from "./schema.js";

const UNITS = [
  ["_n_per_um", "N/µm"], ["_n_per_mm3", "N/mm³"], ["_n_per_m", "N/m"], ["_n_s_per_m", "N s/m"], ["_n_m_per_rad", "N m/rad"],
  ["_n_m_s_per_rad", "N m s/rad"], ["_n_m", "N m"], ["_gpa", "GPa"], ["_degc", "°C"], ["_deg", "°"], ["_per_k", "1/K"],
  ["_g_mm", "g mm"], ["_mm", "mm"], ["_nm", "nm"],
  ["_um", "µm"], ["_rpm", "rpm"], ["_km_h", "km/h"], ["_hz", "Hz"], ["_percent", "%"], ["_n", "N"], ["_s", "s"],
];
export const GEARS = ["pinion", "wheel"];
export const NONE = "not set";
const READ = 40; // characters of a list in a sentence

const endOf = (name) => UNITS.find(([suffix]) => name.endsWith(suffix)) ?? ["", ""];
export const unitOf = (name) => endOf(name)[1];

export function wordsOf(name) {
  const text = name.slice(0, name.length - endOf(name)[0].length).replaceAll("_", " ").replace(/^(young|poisson)s /, "$1's ");
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** A change in a sentence, its unit once; empty where both texts are the same. @param {string} words @param {string} unit @param {string[]} texts */
export function changeIn(words, unit, before, now) {
  const of = (text) => (text === NONE ? text : `${spokenChoice(text)} ${unit}`.trim());
  return before === now ? "" : `${words} ${now === NONE ? of(before) : spokenChoice(before)} → ${of(now)}`;
}

/** What a field of a case is called. @param {string[]} path */
const labelOf = (path) => (GEARS.includes(path[1]) ? path.slice(2).map(wordsOf).join(" · ") : wordsOf(path.at(-1)));

/** The same in a sentence, with the gear that it belongs to. @param {string[]} path */
export function wordsIn(path) {
  const label = labelOf(path);
  return `${GEARS.includes(path[1]) ? `${path[1]} ` : ""}${label.charAt(0).toLowerCase()}${label.slice(1)}`;
}

const spokenChoice = (text) => ({ true: "yes", false: "no" })[text] ?? text.replaceAll("_", " ");

/** A number as typed; text that is none passes as it is, for the service to refuse by name. */
export function numberIn(text) {
  const value = Number(text.replace(",", "."));
  return text !== "" && Number.isFinite(value) ? value : text;
}

export const numbersIn = (text) => text.split(/[,;\s]+/).filter(Boolean).map(numberIn);

/** Tables of numbers as they are typed: "11, 0.2; 92, 0.1" by the order of the columns; null: they hold more than numbers. */
function rowsText(rows, columns) {
  const names = Object.keys(columns);
  const usual = names.map((name) => columns[name].default ?? null);
  const texts = rows.map((row) => {
    const values = names.map((name, k) => row[name] ?? usual[k]);
    const end = values.findLastIndex((value, k) => value !== usual[k]) + 1;
    const more = Object.entries(row).some(([name, value]) => !names.includes(name) && value !== null);
    return more || values.slice(0, end).includes(null) ? null : values.slice(0, end).join(", ");
  });
  return texts.includes(null) ? null : texts.join("; ");
}

const rowsIn = (text, columns) => text.split(";").filter((row) => row.trim()).map(
  (row) => Object.fromEntries(numbersIn(row).map((value, k) => [Object.keys(columns)[k] ?? `number ${k + 1}`, value])));

export class Field {
  /** @param {object} leaf of a schema, and its label if its path does not say it @param {string} [part] of the page, in the id of the control */
  constructor(leaf, part = "f") {
    Object.assign(this, { label: labelOf(leaf.path) }, leaf);
    this.key = leaf.path.join(".");
    this.id = `${part}-${this.key.replaceAll(".", "-")}`;
    this.name = leaf.path.at(-1);
    this.kind = kindOf(leaf.schema);
    this.input = this.control();
    this.views = [this.input]; // controls that show it
    this.message = make("p", { class: "fault", id: `${this.id}-fault`, hidden: true });
    const unit = unitOf(this.name);
    this.wide = ["list", "sentences", "rows", "json"].includes(this.kind);
    const shown = unit ? make("span", { class: "unit", "aria-hidden": "true" }, unit) : null;
    this.entry = make("div", { class: "entry" }, this.input, shown);
  }

  get hint() {
    const full = this.schema.description || "";
    const text = full.replace(/,? in (mm|µm|deg|degrees|N m|GPa)\b/, "");
    return text.toLowerCase() === this.label.toLowerCase() ? "" : text;
  }

  get spoken() {
    const unit = unitOf(this.name);
    return unit ? `${this.label}, ${unit}` : this.label;
  }

  get defaultText() {
    const value = this.schema.default;
    if (value === null || value === undefined) return "";
    return Array.isArray(value) ? value.join(", ") : String(value);
  }

  control() {
    const common = { id: this.id, "aria-describedby": `${this.id}-fault`, name: this.key };
    if (this.kind === "choice" || this.kind === "switch") {
      const options = this.kind === "switch" ? ["true", "false"] : this.schema.enum;
      const none = this.defaultText ? spokenChoice(this.defaultText) : "not chosen";
      return make(
        "select", common, make("option", { value: "" }, none),
        ...options.filter((text) => text !== this.defaultText).map((text) => make("option", { value: text }, spokenChoice(text))),
      );
    }
    const columns = Object.keys(this.schema.columns ?? {}).map((name) => [wordsOf(name).toLowerCase(), unitOf(name)].join(" ").trim());
    const placeholder = { json: "none", rows: `${columns.slice(0, 3).join(", ")}; …` }[this.kind] ?? this.defaultText;
    const keys = this.kind === "number" ? "decimal" : "text";
    return make("input", { ...common, type: "text", inputmode: keys, autocomplete: "off", placeholder });
  }

  set value(value) {
    this.input.value = this.textOf(value);
  }

  /** A value as it is typed; a default is left empty. */
  textOf(value) {
    if (value === undefined || value === null || same(value, this.schema.default)) return "";
    if (this.kind === "list") return value.join(", ");
    if (this.kind === "sentences") return value.join("; ");
    const rows = this.kind === "rows" ? rowsText(value, this.schema.columns) : null;
    return rows ?? (["rows", "json"].includes(this.kind) ? JSON.stringify(value) : String(value));
  }

  /** A change of its value in a sentence. */
  change(...values) {
    const texts = values.map((value) => this.textOf(value) || this.defaultText || NONE);
    return changeIn(wordsIn(this.path), unitOf(this.name), ...texts.map((text) => (text.length > READ ? `${text.slice(0, READ)}…` : text)));
  }

  get value() {
    const text = this.input.value.trim();
    if (text === "") return undefined;
    if (this.kind === "number") return numberIn(text);
    if (this.kind === "switch") return text === "true";
    if (this.kind === "list") return numbersIn(text);
    if (this.kind === "sentences") return text.split(";").map((each) => each.trim()).filter(Boolean);
    if (this.kind === "rows" && !text.startsWith("[")) return rowsIn(text, this.schema.columns);
    if (["rows", "json"].includes(this.kind)) {
      try {
        return JSON.parse(text);
      } catch {
        return text;
      }
    }
    return text;
  }

  /**
   * Show a fault, or none. A field that is being typed into is given time to be finished.
   * @param {string} text
   * @param {number} [patience] milliseconds
   */
  fault(text, patience = 0) {
    clearTimeout(this.pending);
    if (text && patience) this.pending = setTimeout(() => this.fault(text), patience);
    else this.mark(text);
  }

  mark(text) {
    for (const view of this.views) view.setAttribute("aria-invalid", text ? "true" : "false");
    this.message.textContent = text || "";
    this.message.hidden = !text;
  }
}
