// @ts-check
/** The complaint: its frequency, speed and torque in the bar, which are fields of the design, and the order that it is. */

import { button, byId, make, signed } from "./elements.js";
import { numberIn } from "./field.js";
import { mark } from "./plots.js";
import { reveal } from "./tabs.js";

export const WITHIN = 5; // per cent, as the service, where the complaint states no tolerance
const AT = ["tire_radius_mm", "road_speed_km_h"]; // either: the speed is that of the road
const INSTEAD = { frequency_hz: "order", speed_rpm: "road_speed_km_h", road_speed_km_h: "speed_rpm" };

/** @typedef {{order: number, harmonic: number | null, within: number, shaft: string, teeth: number, mesh: number, driver: number, road: number, torque: number}} Heard */

/**
 * What a case complains of: its order of the mesh and the nearest harmonic, null where none is within so many per cent; the
 * frequency of the mesh, Hz, the speed of the driving gear and what 1 km/h is of the complaint's shaft, rpm; the torque, N m.
 * What is not stated is NaN.
 * @param {any} content @returns {Heard}
 */
export function heardIn({ complaint = {}, pair = {}, load = {} }) {
  const { shaft = "pinion", final_shaft: final = "wheel", final_ratio: ratio = 1, tolerance_percent: within = WITHIN } = complaint;
  const teeth = (gear) => Number(pair[gear]?.teeth);
  const road = (1000 * ratio * teeth(final)) / (120 * Math.PI * (complaint.tire_radius_mm / 1000) * teeth(shaft));
  const rpm = Number(complaint.speed_rpm ?? road * complaint.road_speed_km_h);
  const order = Number(complaint.order ?? (60 * complaint.frequency_hz) / rpm) / teeth(shaft);
  const near = Math.max(Math.round(order), 1);
  const harmonic = 100 * Math.abs(near / order - 1) <= within ? near : null;
  const mesh = (teeth(shaft) * rpm) / 60;
  return { order, harmonic, within, shaft, teeth: teeth(shaft), mesh, driver: (60 * mesh) / teeth("pinion"), road, torque: Number(complaint.torque_n_m ?? load.torque_n_m?.at?.(-1)) };
}

/** An order of a shaft in the words of terminal and document: "order 27.0 of the pinion". @param {number} order @param {string} shaft */
export function orderWords(order, shaft) {
  const text = String(Number(order.toPrecision(4)));
  return `order ${/[.e]/.test(text) ? text : `${text}.0`} of ${["pinion", "wheel"].includes(shaft) ? "the " : ""}${shaft}`;
}

/** The order of the shaft with the harmonic of the mesh. @param {Heard} heard */
function wordsOf({ order, harmonic, within, shaft, teeth }) {
  if (!Number.isFinite(order)) return "";
  const near = harmonic ? `harmonic ${harmonic} (${signed(100 * (harmonic / order - 1), 2)} %)` : `no harmonic within ${within} %`;
  return `${orderWords(order * teeth, shaft)}, ${near}`;
}

/** What it is on the axes of plots, by their labels. @param {Heard} heard @returns {Record<string, number>} */
export function axesOf({ order, mesh, driver, torque }) {
  if (!Number.isFinite(order)) return {};
  const orders = ["harmonic of the mesh", "order of the mesh", "mesh order"].map((label) => [label, order]);
  const loads = { "frequency, Hz": order * mesh, "speed of the driving gear, rpm": driver, "torque on the driving gear, N m": torque };
  return { ...Object.fromEntries(orders), ...loads };
}

/** A field of the design in the bar: its number in one of the units, by their sizes in that of the field. */
class View {
  /** @param {any} field @param {string} label @param {(heard: Heard) => Record<string, number>} units @param {(view: View) => void} typed */
  constructor(field, label, units, typed) {
    Object.assign(this, { field, units });
    this.sizes = { "": 1 };
    const facts = { id: `bar-${field.name}`, type: "text", inputmode: "decimal", autocomplete: "off", placeholder: label };
    this.input = make("input", { ...facts, "aria-label": `Complaint, ${label}`, "aria-describedby": field.message.id });
    this.input.addEventListener("input", () => typed(this));
    this.unit = make("select", { "aria-label": `Unit of the complaint's ${label}`, onchange: () => this.put() });
    this.block = make("span", { class: "quantity" }, this.input, this.unit);
    field.views.push(this.input);
  }

  get size() {
    return this.sizes[this.unit.value] ?? 1;
  }

  /** What is typed, in the unit of the field. */
  get value() {
    const text = this.input.value.trim();
    const typed = numberIn(text);
    return text === "" ? undefined : typeof typed === "number" ? Number((typed * this.size).toPrecision(12)) : typed;
  }

  put() {
    const { value } = this.field;
    this.input.value = typeof value === "number" ? String(Number((value / this.size).toPrecision(6))) : value ?? "";
  }

  /** Show what the field has, unless that is what is typed. @param {Heard} heard */
  follow(heard) {
    this.sizes = this.units(heard);
    const names = Object.keys(this.sizes);
    this.unit.disabled = names.length < 2;
    if (names.join() !== [...this.unit.options].map(({ value }) => value).join()) {
      this.unit.replaceChildren(...names.map((name) => make("option", {}, name)));
    }
    if (this.value !== this.field.value) this.put();
  }
}

export class Complaint {
  /** @param {import("./design.js").Design} design */
  constructor(design) {
    this.design = design;
    const view = (name, label, units) => new View(design.field(`complaint.${name}`), label, units, (typed) => this.take(typed));
    this.views = [
      view("frequency_hz", "frequency", () => ({ Hz: 1, kHz: 1000 })),
      view("speed_rpm", "speed", () => ({ rpm: 1 })),
      view("road_speed_km_h", "road speed", ({ road }) => (road ? { "km/h": 1, rpm: 1 / road } : { "km/h": 1 })),
      view("torque_n_m", "torque", () => ({ "N m": 1 })),
    ];
    this.words = make("output", { for: this.views.map(({ input }) => input.id).join(" ") });
    const all = button("Complaint", () => {
      reveal(byId("f-complaint-frequency_hz"));
      byId("f-complaint-frequency_hz").focus();
    }, { title: "All fields of the complaint" });
    byId("complaint").replaceChildren(all, ...this.views.map(({ block }) => block), this.words);
    design.watch(() => this.follow());
  }

  follow() {
    const { case: content } = this.design;
    const heard = heardIn(content);
    const road = AT.some((name) => content.complaint?.[name] !== undefined);
    for (const view of this.views) {
      view.block.hidden = view.field.name === (road ? "speed_rpm" : "road_speed_km_h");
      view.follow(heard);
    }
    this.say(wordsOf(heard));
    mark(axesOf(heard));
  }

  /** @param {string} text what the complaint is */
  say(text) {
    this.words.textContent = this.words.title = text;
  }

  /** Edit the field of a view; what it is an alternative to is left out. @param {View} view */
  take({ field: { name }, value }) {
    const other = INSTEAD[name];
    this.design.take({ [`complaint.${name}`]: value, ...(other && value !== undefined ? { [`complaint.${other}`]: undefined } : {}) });
  }
}
