/** A study on the page: what it does, its fields, a button, progress and what came out. */

import { Problem } from "./api.js";
import { make } from "./elements.js";
import { showFailure } from "./job.js";

/**
 * @typedef {{name: string, label: string, value?: string, choices?: [string, string][], list?: boolean}} StudyField
 *   a number, a list of numbers, or one of choices
 */

function control({ name, label, value = "", choices, list = false }, title) {
  const id = `study-${title}-${name}`.replaceAll(" ", "-");
  const input = choices
    ? make("select", { id }, ...choices.map(([choice, text]) => make("option", { value: choice }, text)))
    : make("input", { type: "text", inputmode: list ? "text" : "decimal", id, size: list ? 22 : 8, autocomplete: "off" });
  if (!choices) input.value = value;
  const read = choices ? (text) => text : list ? numbersIn : numberIn;
  return { name, input, read, block: make("span", { class: "row" }, make("label", { for: id }, label), input) };
}

/** A number as typed; text that is none passes as it is, for the service to refuse by name. */
function numberIn(text) {
  const value = Number(text.replace(",", "."));
  return Number.isFinite(value) ? value : text;
}

const numbersIn = (text) => text.split(/[,;\s]+/).filter(Boolean).map(numberIn);

/** What was typed, by name; empty fields are left out. */
function valuesOf(controls) {
  const given = controls.filter(({ input }) => input.value.trim() !== "");
  return Object.fromEntries(given.map(({ name, input, read }) => [name, read(input.value)]));
}

/**
 * @param {{title: string, text: string, action: string, fields?: StudyField[], more?: Node[], level?: string}} study
 * @param {(values: object, progress: Node, result: Node) => Promise<void>} start
 */
export function card({ title, text, action, fields = [], more = [], level = "h3" }, start) {
  const controls = fields.map((field) => control(field, title));
  const progress = make("div");
  const result = make("div", { class: "result" });
  const button = make("button", { type: "button" }, action);
  button.addEventListener("click", async () => {
    button.disabled = true;
    result.replaceChildren();
    try {
      await start(valuesOf(controls), progress, result);
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      showFailure(progress, problem);
    } finally {
      button.disabled = false;
    }
  });
  const row = make("div", { class: "row" }, ...controls.map(({ block }) => block), button);
  return make("div", { class: "study" }, make(level, {}, title), make("p", { class: "hint" }, text), ...more, row, progress, result);
}
