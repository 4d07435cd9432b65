/** The parts of a scene as tables, one row per part: cells by the schema of the scene, references as lists of the names there are. */

import { button, byId, make } from "./elements.js";
import { Field, wordsOf } from "./field.js";
import { at, changed, kindOf, resolved } from "./schema.js";

const SHORT = 6; // values of a list that is edited in its cell
const TYPED = ["number", "text", "choice", "switch", "list"];
const WIDTHS = { number: 9, text: 14, list: 12 }; // characters

export class SceneTable {
  /** @param {object} root schema of a scene @param {(scene: object) => void} edited */
  constructor(root, edited) {
    Object.assign(this, { root, edited });
    const { schema } = resolved(root, root);
    this.references = schema["x-references"];
    const kinds = Object.entries(schema.properties).map(([kind, inner]) => {
      const own = resolved(inner, root).schema;
      return [kind, { listed: Boolean(own.items), ...resolved(own.items ?? own, root).schema }];
    });
    /** @type {Map<string, any>} schemas of parts by the names of their tables */
    this.kinds = new Map(kinds.filter(([, { properties }]) => properties));
    this.block = make("div");
    this.opened = new Set(); // columns without a value
  }

  /** Show a scene; what has the focus keeps it. @param {any} scene @param {string} [focus] what has it from now on */
  show(scene, focus = this.block.contains(document.activeElement) ? document.activeElement.id : "") {
    this.scene = scene;
    /** @type {Map<string, Field>} */
    this.fields = new Map();
    const shown = [...this.kinds.keys()].filter((kind) => this.rows(kind).length);
    this.block.replaceChildren(...shown.map((kind) => this.table(kind)), this.choice("add", "Add a part", this.listed, (kind) => this.add(kind)));
    byId(focus)?.focus();
    byId(focus)?.select?.();
  }

  /** Take a scene of which one value was changed elsewhere; what is typed in the other cells stays. */
  take(scene, path) {
    this.scene = scene;
    this.fields.get(path.join(".")).value = at(scene, path);
  }

  get listed() {
    return [...this.kinds.keys()].filter((kind) => this.kinds.get(kind).listed);
  }

  rows(kind) {
    return [this.scene[kind] ?? []].flat();
  }

  names(kind) {
    return this.rows(kind).map(({ name }) => name);
  }

  /** The parts of a kind. */
  table(kind) {
    const { properties, required = [], listed } = this.kinds.get(kind);
    const rows = this.rows(kind);
    const used = (name) => required.includes(name) || this.opened.has(`${kind}.${name}`) || rows.some((row) => (row[name] ?? null) !== null);
    const names = Object.keys(properties).filter(used);
    const title = wordsOf(kind);
    const heads = names.map((name) => make("th", { scope: "col", title: properties[name].description }, new Field(this.leaf([kind, 0, name])).spoken));
    const body = rows.map((row, k) => make("tr", {}, ...names.map((name) => this.cell(listed ? [kind, k, name] : [kind, name], `${row.name ?? title}`)),
      listed ? make("td", { class: "buttons" }, ...this.buttons(kind, k)) : null));
    const left = Object.keys(properties).filter((name) => !used(name) && TYPED.includes(kindOf(this.leaf([kind, 0, name]).schema)));
    const further = left.length ? this.choice(kind, `Further field of ${title.toLowerCase()}`, left, (name) => this.open(kind, name, listed)) : null;
    return make("div", { class: "scroll parts-table" }, make("table", { class: "data" }, make("caption", {}, title),
      make("thead", {}, make("tr", {}, ...heads, make("td", {}, further))), make("tbody", {}, ...body)));
  }

  /** A cell: a control, or a few words for what is edited as text. */
  cell(path, of) {
    const leaf = this.leaf(path);
    const value = at(this.scene, path);
    const kind = kindOf(leaf.schema);
    if (!TYPED.includes(kind) || (kind === "list" && value?.length > SHORT)) return make("td", { class: "hint" }, inWords(path.at(-1), value));
    const field = new Field(leaf, "scene");
    field.value = value;
    field.input.ariaLabel = `${field.spoken}, ${of}`;
    field.input.dataset.unkept = "";
    if (field.input.type === "text") field.input.size = WIDTHS[kind];
    field.input.addEventListener("change", () => this.put(path, field.value));
    this.fields.set(field.key, field);
    return make("td", {}, field.input, field.message);
  }

  /** A field of a part with its schema; one that names a part has the names that there are. */
  leaf(path) {
    const [kind, name] = [path[0], path.at(-1)];
    const { properties } = this.kinds.get(kind);
    const { schema, nullable } = resolved(properties[name], this.root);
    const of = this.references[kind]?.[name];
    const value = at(this.scene, path);
    const choices = of ? { enum: [...new Set([...this.names(of), value].filter((each) => typeof each === "string"))] } : {};
    return { path, schema: { ...schema, ...choices }, nullable };
  }

  buttons(kind, k) {
    const name = this.rows(kind)[k].name ?? `${kind} ${k + 1}`;
    const small = (word, action) => button(word, action, { class: "small", "aria-label": `${word} ${name}`, id: `scene-${word.toLowerCase()}-${kind}-${k}` });
    return [small("Copy", () => this.copy(kind, k)), small("Remove", () => this.remove(kind, k))];
  }

  /** A list of which an entry that is chosen is done at once. @param {string} id @param {string} label @param {string[]} names @param {(name: string) => void} chosen */
  choice(id, label, names, chosen) {
    const list = make("select", { id: `scene-choice-${id}`, "aria-label": label, "data-unkept": true, onchange: () => list.value && chosen(list.value) },
      make("option", { value: "" }, `${label.split(" of ")[0]}…`), ...names.map((name) => make("option", { value: name }, wordsOf(name))));
    return list;
  }

  /** Show a column that is still empty. */
  open(kind, name, listed) {
    this.opened.add(`${kind}.${name}`);
    this.show(this.scene, listed ? `scene-${kind}-0-${name}` : `scene-${kind}-${name}`);
  }

  /** Take a value that was typed; a part that is called otherwise stays the one that others name. */
  put(path, value) {
    const [kind, k, name] = path;
    const before = at(this.scene, path);
    this.scene = changed(this.scene, path, value);
    if (name === "name") {
      this.rename(kind, before, value);
      setTimeout(() => this.show(this.scene)); // the focus has moved on then
    }
    this.edited(this.scene);
  }

  rename(named, before, now) {
    for (const [kind, fields] of Object.entries(this.references)) {
      for (const [field] of Object.entries(fields).filter(([, of]) => of === named)) {
        this.rows(kind).forEach((row, k) => {
          if (row[field] === before) this.scene = changed(this.scene, [kind, k, field], now);
        });
      }
    }
  }

  /** Put other parts in place of those of a kind. */
  list(kind, rows, focus) {
    this.show(changed(this.scene, [kind], rows.length ? rows : undefined), focus);
    this.edited(this.scene);
  }

  copy(kind, k) {
    const rows = this.rows(kind);
    this.list(kind, rows.toSpliced(k + 1, 0, this.called(kind, rows[k])), `scene-${kind}-${k + 1}-name`);
  }

  remove(kind, k) {
    const rows = this.rows(kind).toSpliced(k, 1);
    this.list(kind, rows, rows.length ? `scene-remove-${kind}-${Math.min(k, rows.length - 1)}` : "scene-choice-add");
  }

  /** Add a part with the examples of what it needs. */
  add(kind) {
    const { properties, required = [], allOf = [] } = this.kinds.get(kind);
    const needed = [...required, ...allOf.flatMap(({ oneOf }) => oneOf?.[0].required ?? [])];
    const values = needed.map((name) => {
      const names = this.names(this.references[kind]?.[name]);
      return [name, names[0] ?? properties[name].examples?.[0]];
    });
    const rows = this.rows(kind);
    this.list(kind, [...rows, this.called(kind, Object.fromEntries(values))], `scene-${kind}-${rows.length}-name`);
  }

  /** A part with a name that no other of its kind has. */
  called(kind, part) {
    if (!("name" in part)) return part;
    const [bare, names] = [part.name.replace(/ \d+$/, ""), this.names(kind)];
    let name = part.name;
    for (let k = 2; names.includes(name); k += 1) name = `${bare} ${k}`;
    return { ...part, name };
  }

  /**
   * Say at its cell what is wrong.
   * @param {{field: string, bound: string, suggestion?: string}[]} faults
   * @returns {Node[]} what leads to the cells, or says what is wrong with a field that has none
   */
  refuse(faults) {
    for (const field of this.fields.values()) field.fault("");
    return faults.map((fault) => {
      const text = `must be ${fault.bound}${fault.suggestion ? `. ${fault.suggestion}` : ""}`;
      const field = this.nearest(fault.field.replaceAll(/\[(\d+)\]/g, ".$1").split("."));
      field?.fault(text);
      return make("li", {}, field ? button(fault.field, () => field.input.focus(), { class: "small" }) : `${fault.field} ${text}`);
    });
  }

  nearest(path) {
    return path.length ? this.fields.get(path.join(".")) ?? this.nearest(path.slice(0, -1)) : undefined;
  }
}

/** What a table does not show of a field. @param {string} name @param {any} value */
function inWords(name, value) {
  if ((value ?? null) === null) return "";
  if (!Array.isArray(value)) return `${Object.keys(value).length} fields`;
  return `${value.length} ${typeof value[0] === "object" ? wordsOf(name).toLowerCase() : "values"}`;
}
