// @ts-check
/** Where a relief starts, in the ways that drawings have (ISO 21771-1), and the switch between them at its field. */

import { post } from "./api.js";
import { make } from "./elements.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {{base: number, form: number, tip: number}} Circles radii of a gear, mm */

const DEGREE = Math.PI / 180;
const DIGITS = 9; // of a converted value

const rolled = (radius, base) => Math.sqrt(Math.max(radius ** 2 - base ** 2, 0));
const WAYS = [ // the radius of a value, and the value of a radius; a relief runs from `other` towards `end`
  {
    ending: "length_mm", words: "mm", title: "length along the radius",
    radius: (value, { end, other }) => end + Math.sign(other - end) * value, value: (radius, { end }) => Math.abs(end - radius),
  },
  {
    ending: "start_diameter_mm", words: "mm ⌀", title: "start diameter",
    radius: (value) => value / 2, value: (radius) => 2 * radius,
  },
  {
    ending: "start_roll_length_mm", words: "mm roll", title: "start as roll length",
    radius: (value, { base }) => Math.hypot(base, value), value: (radius, { base }) => rolled(radius, base),
  },
  {
    ending: "start_roll_angle_deg", words: "° roll", title: "start as roll angle",
    radius: (value, { base }) => Math.hypot(base, base * value * DEGREE), value: (radius, { base }) => rolled(radius, base) / base / DEGREE,
  },
];
const wayOf = (name) => WAYS.find(({ ending }) => name.endsWith(`relief_${ending}`));

/** Whether a field is one way to state where a relief starts. @param {any} schema */
export const isStart = (schema) => schema["x-kind"] === "start";

/** The value of one field as another states it. @param {number} value @param {string} from @param {string} to @param {Circles} circles */
function converted(value, from, to, { base, form, tip }) {
  const [end, other] = from.startsWith("tip") ? [tip, form] : [form, tip];
  const along = { base, end, other };
  return Number(wayOf(to).value(wayOf(from).radius(value, along), along).toPrecision(DIGITS));
}

/** The start that a gear states instead of a length, as [field, value]. @param {Record<string, any>} gear @param {string} length */
function statedStart(gear, length) {
  if (!length.endsWith("length_mm")) return undefined;
  const relief = length.replace(/length_mm$/, "start_");
  return Object.entries(gear).find(([name, value]) => name.startsWith(relief) && typeof value === "number");
}

/** The circles of both gears, by which lengths follow from starts; none where a case states no start. @param {any} content */
export async function circlesOf(content) {
  const { pinion, wheel } = content.pair ?? {};
  if (![pinion, wheel].some((gear) => Object.keys(gear ?? {}).some((name) => /_relief_start_/.test(name)))) return undefined;
  const outline = await post("/v1/cases/outline", { inputs: { case: content } });
  return { pinion: outline.pinion.radius_mm, wheel: outline.wheel.radius_mm };
}

/** A length of a gear's flanks, also where its start is stated. @param {Record<string, any>} gear @param {string} length @param {Circles} circles */
export function lengthOf(gear, length, circles) {
  const stated = statedStart(gear, length);
  return stated ? converted(stated[1], stated[0], length, circles) : gear[length];
}

/** What a live request states of a flank, of a field of a case; nothing for a length that is not stated. @param {Field} field @param {any} content @param {any} circles */
export function flankOf({ path: [, gear, name], schema }, content, circles) {
  const figure = isStart(schema) ? name.replace(/start_.*/, "length_mm") : name;
  const value = lengthOf(content.pair[gear], figure, circles?.[gear]) ?? (figure.endsWith("length_mm") ? undefined : schema.default);
  return value === undefined ? {} : { [figure]: value };
}

/** Flanks as values of fields, reliefs in the form in which a case states them. @param {any} flanks by gear and field @param {any} content */
export async function asStated(flanks, content) {
  const circles = await circlesOf(content);
  return Object.fromEntries(["pinion", "wheel"].flatMap((gear) => Object.entries(flanks[gear] ?? {}).map(([name, value]) => {
    const [start] = statedStart(content.pair[gear], name) ?? [];
    return [`pair.${gear}.${start ?? name}`, start ? converted(value, name, start, circles[gear]) : value];
  })));
}

/** The fields of one relief of a gear, of which one is shown. */
export class StartSwitch {
  /**
   * @param {Field[]} fields its length first, then the other ways
   * @param {string} gear
   * @param {() => Promise<any>} outline of the case as typed; undefined where it is refused
   */
  constructor(fields, gear, outline) {
    Object.assign(this, { fields, gear, outline });
    const options = fields.map(({ key, name }) => make("option", { value: key, title: wayOf(name).title }, wayOf(name).words));
    const words = `${fields[0].label.replace(/ length$/, "")}, ${gear}: stated by`;
    this.select = make("select", { "aria-label": words, "data-unkept": "" }, ...options);
    this.select.addEventListener("change", () => this.turn());
    this.parts = make("div", { class: "switched" }, ...fields.map(({ entry }) => entry), this.select);
    this.sync();
  }

  get shown() {
    return this.fields.find(({ entry }) => !entry.hidden);
  }

  /** Show the way that has a value; without any the one that is shown. */
  sync() {
    this.show(this.fields.find((field) => field.value !== undefined) ?? this.shown);
  }

  /** @param {Field} field */
  show(field) {
    for (const { entry, message, key } of this.fields) {
      entry.hidden = key !== field.key;
      if (entry.hidden) message.hidden = true;
    }
    this.select.value = field.key;
  }

  /** Let one way alone have a value. @param {Field} field */
  only(field) {
    if (field.value !== undefined) for (const other of this.fields) if (other !== field) other.value = undefined;
    this.sync();
  }

  /** Go to the way that was chosen: the same point of the flank, in its unit. */
  async turn() {
    const [from, to] = [this.shown, this.fields.find(({ key }) => key === this.select.value)];
    const { value } = from;
    if (typeof value === "number") {
      this.select.value = from.key; // until it is known
      const known = await this.outline();
      if (!known || from.value !== value) return;
      to.value = converted(value, from.name, to.name, known[this.gear].radius_mm);
      from.value = undefined;
    }
    this.show(to);
    to.input.dispatchEvent(new Event("input", { bubbles: true }));
  }
}
