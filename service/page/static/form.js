/** The case as a form, made from the schema that the service checks cases with. */

import { ask, guarded } from "./api.js";
import { byId, folded, make } from "./elements.js";
import { Field, GEARS, unitOf, wordsIn } from "./field.js";
import { StartSwitch, isStart } from "./relief_start.js";
import { at, leaves, ofFlank, pairAlone, put, resolved } from "./schema.js";
import { reveal } from "./tabs.js";

/** Rows of the table of gears that are always shown; the others open when asked for. */
const MAIN = new Set([
  "teeth", "face_width_mm", "bore_diameter_mm", "rim_diameter_mm", "profile_shift_coefficient", "tip_relief_um",
  "tip_relief_length_mm", "helix_crowning_um", "internal",
]);
const TEETH = /^(addendum|dedendum|root_radius|tip_diameter|thickness|cutter)/;
const AS_MADE = /^(single_pitch|pitch_deviation|run_out|waves|tooth_flanks)/;
const GROUPS = {
  "Teeth": (name) => TEETH.test(name),
  "Flank modifications": ofFlank,
  "Teeth as made": (name) => AS_MADE.test(name),
  "Body, seat and shaft": () => true,
};

const TYPING = 1500; // milliseconds after which a field that has the focus says what is wrong with it

export class CaseForm {
  /**
   * @param {object} root schema of a case
   * @param {object[]} effects what the service offers
   * @param {() => void} changed called after every edit
   */
  constructor(root, effects, changed) {
    this.fields = new Map();
    this.switches = [];
    this.changed = changed;
    const { schema } = resolved(root, root);
    const part = (name) => resolved(schema.properties[name], root).schema;
    byId("fields").prepend(
      ...this.pair(part("pair"), root),
      this.plain("Material", "material", part("material"), root),
      this.plain("Loads", "load", part("load"), root),
      this.plain("Assembly errors", "errors", part("errors"), root),
      this.plain("Accuracy", "accuracy", part("accuracy"), root, ["tolerance", "level", "model"]),
      this.plain("Complaint", "complaint", part("complaint"), root, ["frequency_hz", "order", "speed_rpm", "road_speed_km_h"]),
      this.effects(effects),
      this.plain("Report", "report", part("report"), root, ["title", "project"]),
    );
    byId("case-form").addEventListener("input", (event) => {
      this.fields.get(event.target.name)?.fault("");
      event.target.closest(".replaced")?.classList.remove("replaced");
      if (this.fields.has(event.target.name)) changed();
    });
    byId("case-form").addEventListener("submit", (event) => event.preventDefault());
    document.addEventListener("typed", () => this.switches.forEach((one) => one.sync()));
  }

  add(leaf) {
    const field = new Field(leaf);
    this.fields.set(field.key, field);
    return field;
  }

  /** One field under its label. */
  block(field) {
    const unit = unitOf(field.name);
    const spoken = unit ? make("span", { class: "unseen" }, `, ${unit}`) : null;
    return make(
      "div", { class: field.wide ? "field wide" : "field" },
      make("label", { for: field.id }, field.label, spoken), field.entry,
      make("span", { class: "hint" }, field.hint), field.message,
    );
  }

  plain(title, name, schema, root, main = null) {
    const found = leaves(schema, root, [name]).map((leaf) => this.add(leaf));
    const shown = main ? found.filter((field) => main.includes(field.name)) : found;
    const rest = found.filter((field) => !shown.includes(field));
    const grid = (fields) => make("div", { class: "fields" }, ...fields.map((field) => this.block(field)));
    return node(title, grid(shown), rest.length ? folded("More", grid(rest)) : null);
  }

  pair(schema, root) {
    const shared = Object.entries(schema.properties).filter(([name]) => !GEARS.includes(name));
    const fields = shared.map(([name, inner]) => (
      this.block(this.add({ path: ["pair", name], ...resolved(inner, root), required: schema.required.includes(name) }))));
    const gears = GEARS.map((gear) => new Map(
      leaves(schema.properties[gear], root, ["pair", gear]).map((leaf) => [leaf.path.slice(2).join("."), leaf]),
    ));
    const leaf = (name) => gears[0].get(name) ?? gears[1].get(name);
    const names = [...new Set([...gears[0].keys(), ...gears[1].keys()])].filter((name) => !isStart(leaf(name).schema));
    const order = [...MAIN].filter((name) => names.includes(name));
    const left = new Set(names.filter((name) => !MAIN.has(name)));
    const main = this.gearTable("Main data of both gears", order, gears);
    const groups = Object.entries(GROUPS).map(([title, belongs]) => {
      const mine = [...left].filter((name) => belongs(name, leaf(name).schema));
      mine.forEach((name) => left.delete(name));
      return node(title, this.gearTable(title, mine, gears), null, 1);
    });
    return [node("Gear pair", make("div", { class: "fields" }, ...fields, main)), ...groups];
  }

  gearTable(caption, names, gears) {
    const heads = ["", "Pinion", "Wheel"].map((text, k) => (
      k === 0 ? make("td") : make("th", { scope: "col" }, text)));
    const rows = names.flatMap((name) => {
      const fields = gears.map((gear, k) => gear.has(name) && this.ofGear(gear.get(name), GEARS[k]));
      const [field] = fields.filter(Boolean);
      const label = (text) => make("th", { scope: "row" }, text, make("span", { class: "hint" }, field.hint));
      const starts = gears.map((gear, k) => this.starts(name, gear, GEARS[k]));
      const cell = (one, facts = {}) => (one ? make("td", facts, one.entry, one.message) : make("td"));
      if (starts[0].length) {
        const cells = starts.map((own, k) => this.switched([fields[k], ...own], GEARS[k]));
        return make("tr", {}, label(`${field.label} or start`), ...cells);
      }
      if (!field.wide) return make("tr", {}, label(field.spoken), ...fields.map((one) => cell(one)));
      return fields.filter(Boolean).map((one) => make("tr", {}, label(one.input.ariaLabel), cell(one, { colspan: 2 })));
    });
    return make(
      "table", { class: "gears", "aria-label": caption },
      make("thead", {}, make("tr", {}, ...heads)), make("tbody", {}, ...rows),
    );
  }

  /** The fields that state where a relief starts, in place of its length. */
  starts(name, gear, of) {
    const relief = name.replace(/length_mm$/, "start_");
    return [...gear].filter(([own, leaf]) => isStart(leaf.schema) && own.startsWith(relief)).map(([, leaf]) => this.ofGear(leaf, of));
  }

  /** The cell of a relief, of whose ways one is shown. */
  switched(fields, gear) {
    const outline = () => guarded(() => ask("outline", { inputs: { case: pairAlone(this.case) } }), (problem) => this.refuse(problem));
    const own = new StartSwitch(fields, gear, outline);
    this.switches.push(own);
    return make("td", {}, own.parts, ...fields.map((field) => field.message));
  }

  ofGear(leaf, gear) {
    const field = this.add(leaf);
    field.input.setAttribute("aria-label", `${field.spoken}, ${gear}`);
    return field;
  }

  effects(effects) {
    const fields = effects.map(({ name, cost }) => this.block(this.add({
      path: ["effects", name], schema: { enum: ["auto", "on", "off"], default: "auto", description: `Costs ${cost}` }, nullable: false,
    })));
    const note = make("p", { class: "hint" }, "auto: on where the case calls for it and the accuracy asked for needs it.");
    return node("Effects", make("div", { class: "fields" }, note, ...fields));
  }

  /** Show a case. */
  set case(content) {
    for (const field of this.fields.values()) {
      field.value = at(content, field.path);
      field.fault("");
    }
    for (const own of this.switches) own.sync();
    this.clear();
  }

  /** The case as typed: what is empty is left out. */
  get case() {
    const content = {};
    for (const field of this.fields.values()) {
      const value = field.value;
      if (value !== undefined) put(content, field.path, value);
    }
    return content;
  }

  set(key, value) {
    const field = this.fields.get(key);
    if (!field) return;
    field.value = value;
    this.switchOf(field)?.only(field);
  }

  switchOf(field) {
    return this.switches.find(({ fields }) => fields.includes(field));
  }

  /** Fields without which there is no case, and which are empty. */
  get missing() {
    const loads = ["load.torque_n_m", "load.normal_force_n"].map((key) => this.fields.get(key));
    const unloaded = loads.every((field) => field.value === undefined) ? [loads[0]] : [];
    return [...[...this.fields.values()].filter((field) => field.required && field.value === undefined), ...unloaded];
  }

  clear() {
    for (const field of this.fields.values()) field.fault("");
    byId("form-errors").hidden = true;
    byId("form-errors").replaceChildren();
  }

  /** Show a refusal: what is still to fill in, each fault at its field, all of them in a list that leads there. */
  refuse(problem, { focus = false } = {}) {
    const absent = ({ value, bound }) => value === null && bound.startsWith("given");
    const faults = problem.errors.filter((fault) => !absent(fault));
    const named = problem.errors.filter(absent).map(({ field }) => this.fields.get(field)).filter(Boolean);
    const missing = [...new Set([...this.missing, ...named])];
    const items = faults.map((fault) => this.item(fault, focus ? 0 : TYPING));
    const parts = [];
    if (missing.length) parts.push(make("p", {}, make("strong", {}, "Still to fill in: "), ...missing.flatMap((field, k) => [k ? ", " : "", this.link(field, wordsIn(field.path))]), "."));
    if (items.length) parts.push(make("strong", {}, "This case cannot be computed:"), make("ul", {}, ...items));
    const box = byId("form-errors");
    box.replaceChildren(...(parts.length ? parts : [make("strong", {}, problem.message)]));
    box.classList.toggle("alarm", faults.length > 0 || !missing.length);
    box.hidden = false;
    if (focus) box.focus();
  }

  link(field, text) {
    const open = (event) => {
      event.preventDefault();
      this.reveal(field);
    };
    return make("a", { href: `#${field.id}`, onclick: open }, text);
  }

  /** One fault in the list; its field says it too, once it is not being typed into. */
  item(fault, patience) {
    const field = this.nearest(fault.field);
    const text = `must be ${fault.bound}${fault.suggestion ? `. ${fault.suggestion}` : ""}`;
    if (!field) return make("li", {}, `${fault.field} ${text}`);
    field.fault(text, field.input === document.activeElement ? patience : 0);
    return make("li", {}, this.link(field, fault.field), ` ${text}`);
  }

  nearest(name) {
    const bare = name.replace(/\[.*$/, "");
    return this.fields.get(bare) || [...this.fields.values()].find((field) => field.key.startsWith(`${bare}.`));
  }

  reveal(field) {
    this.switchOf(field)?.show(field);
    reveal(field.input);
    field.input.focus();
  }
}

/** A node of the tree of the design with its fields. */
function node(title, content, more = null, level = 0) {
  return make("div", { id: `node-${title.toLowerCase().replaceAll(/\W+/g, "-")}`, "data-title": title, "data-level": level }, content, more);
}
