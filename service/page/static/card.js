/** A study on the page: what it does, its fields, a button, progress and what came out. */

import { make } from "./elements.js";
import { numberIn, numbersIn } from "./field.js";
import { at } from "./schema.js";

/**
 * @typedef {{name: string, label: string, value?: string, choices?: [string, string][], list?: boolean}} StudyField
 *   a number, a list of numbers, or one of choices
 */

function control({ name, label, value = "", choices, list = false }, title) {
  const id = `study-${title}-${name}`.replaceAll(" ", "-");
  const input = choices
    ? make("select", { id }, ...choices.map(([choice, text]) => make("option", { value: choice }, text)))
    : make("input", { type: "text", inputmode: list ? "text" : "decimal", id, size: list ? 22 : 8, autocomplete: "off" });
  input.value = value || input.value;
  const usual = input.value;
  const write = (stated) => {
    const text = [stated ?? usual].flat().join(", ");
    if (!choices?.every(([choice]) => choice !== text)) input.value = text;
  };
  const read = choices ? (text) => text : list ? numbersIn : numberIn;
  return { name, input, read, write, block: make("span", { class: "row" }, make("label", { for: id }, label), input) };
}

/** What was typed, by name, in a table where the name is a path; empty fields are left out. */
function valuesOf(controls) {
  const values = {};
  for (const { name, input, read } of controls.filter(({ input }) => input.value.trim() !== "")) {
    const path = name.split(".");
    const last = path.pop();
    path.reduce((table, key) => (table[key] ??= {}), values)[last] = read(input.value);
  }
  return values;
}

/**
 * @param {{title: string, text: string, action: string, fields?: StudyField[], more?: Node[]}} study
 * @param {(parts: object) => import("./slot.js").Slot} slot shows the job in the card's parts
 * @param {(values: object) => {process: string, inputs: object | (() => Promise<object>)}} job of what was typed
 * @param {(order: {processID: string, inputs: object}) => object} typed what was typed for a job
 */
export function card({ title, text, action, fields = [], more = [] }, slot, job, typed = ({ inputs }) => inputs) {
  const controls = fields.map((field) => control(field, title));
  const parts = { progress: make("div"), result: make("div", { class: "result" }), button: make("button", { type: "button" }, action) };
  const row = make("div", { class: "row" }, ...controls.map(({ block }) => block), parts.button);
  const block = make(
    "div", { class: "study" }, make("h3", {}, title), make("p", { class: "hint" }, text), ...more, row, parts.progress, parts.result,
  );
  const shown = slot(parts);
  shown.fill = (order) => {
    const values = typed(order);
    for (const { name, write } of controls) write(at(values, name.split(".")));
  };
  parts.button.addEventListener("click", () => {
    const { process, inputs } = job(valuesOf(controls));
    shown.submit(process, inputs);
  });
  return block;
}
