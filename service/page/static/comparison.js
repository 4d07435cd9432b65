// @ts-check
/** What two designs differ in, in the words of the form. */

import { at, same } from "./schema.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {{field: Field, words: string, before: string, now: string}} Difference */

/** @param {Field} field @param {object} content */
const valueIn = (field, content) => at(content, field.path) ?? field.schema.default ?? null;

/**
 * Every field in which two cases differ.
 * @param {Iterable<Field>} fields
 * @param {object} before
 * @param {object} now
 * @returns {Difference[]}
 */
export function differences(fields, before, now) {
  return [...fields].filter((field) => !same(valueIn(field, before), valueIn(field, now))).map((field) => ({
    field, words: field.words, before: field.wordsFor(at(before, field.path)), now: field.wordsFor(at(now, field.path)),
  }));
}
