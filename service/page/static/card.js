/** A study on the page: what it does, its fields, a button, progress and what came out. */

import { button, make } from "./elements.js";
import { Field } from "./field.js";
import { at, put, resolved, same } from "./schema.js";

/**
 * @typedef {{process: string, title: string, text: string, action: string, fields: Record<string, object>}} Study as the service
 *   describes it: its fields by their paths in the inputs, each with its schema
 */

/** @param {Study} study */
function fieldsOf({ title, fields }) {
  const part = `study-${title.replaceAll(" ", "-")}`;
  return Object.entries(fields).map(([name, schema]) => (
    new Field({ path: name.split("."), label: schema.title, ...resolved(schema, schema) }, part)));
}

/** A field under its label. @param {Field} field */
function entry({ input, kind, id, label, message }) {
  if (kind !== "choice") input.size = kind === "list" ? 22 : 8;
  return make("div", { class: "row" }, make("label", { for: id }, label), input, message);
}

/** What was typed, in a table; where nothing was, what is usual. @param {Field[]} fields */
function valuesOf(fields) {
  const values = {};
  for (const { path, value, schema } of fields) if ((value ?? schema.default ?? null) !== null) put(values, path, value ?? schema.default);
  return values;
}

/**
 * @param {Study} study
 * @param {{slot: Function, show: Function}} page
 * @param {(values: any) => {process?: string, inputs: object | (() => object | Promise<object>)}} job of what was typed
 * @param {{typed?: (order: {processID: string, inputs: any}) => any, more?: Node[]}} [own] what was typed for a job; what stands above the fields
 */
export function card(study, { slot, show }, job, { typed = ({ inputs }) => inputs, more = [] } = {}) {
  const { process, title, text, action } = study;
  const fields = fieldsOf(study);
  const submit = () => {
    const { process: other, inputs } = job(valuesOf(fields));
    shown.submit(other ?? process, inputs);
  };
  const parts = { progress: make("div"), result: make("div", { class: "result" }), button: button(action, submit) };
  const row = make("div", { class: "row" }, ...fields.map(entry), parts.button);
  const block = make(
    "div", { class: "study" }, make("h3", {}, title), make("p", { class: "hint" }, text), ...more, row, parts.progress, parts.result,
  );
  const shown = slot(process, parts, show);
  shown.fill = (order) => {
    const values = typed(order);
    for (const field of fields) {
      const stated = at(values, field.path);
      field.value = same(stated, field.schema.default) ? null : stated;
    }
  };
  return block;
}
