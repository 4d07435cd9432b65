// @ts-check
/** What two designs differ in, in the words of the form. */

import { at } from "./schema.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {{field: Field, text: string}} Difference in words, none where they read alike */

/** What a field has in a case; left out, what the service takes. @param {Field} field @param {object} content */
function valueIn({ path, schema }, content) {
  const stated = (name) => Boolean(at(content, [...path.slice(0, -1), name]));
  const { value, with: needed = [], without = [] } = schema["x-usual"] ?? {}; // by what is stated beside it
  const usual = needed.every(stated) && !without.some(stated) ? value : undefined;
  return at(content, path) ?? usual ?? schema.default ?? null;
}

/**
 * Every field in which two cases differ.
 * @param {Iterable<Field>} fields
 * @param {object} before
 * @param {object} now
 * @returns {Difference[]}
 */
export function differences(fields, before, now) {
  const textIn = (field, content) => field.textOf(valueIn(field, content)); // of tables as they are typed, without what is left out
  return [...fields].filter((field) => textIn(field, before) !== textIn(field, now)).map((field) => (
    { field, text: field.change(at(before, field.path), at(now, field.path)) }));
}
