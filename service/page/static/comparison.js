// @ts-check
/** What two designs differ in, and which flank modifications one has, in the words of the form. */

import { at, ofFlank, same } from "./schema.js";

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

/**
 * Words for a pair and all of its flank modifications.
 * @param {Iterable<Field>} fields
 * @param {any} content
 */
export function flankWords(fields, content) {
  const modified = [...fields].filter((field) => (
    field.path[0] === "pair" && ofFlank(field.path.slice(2).join("."), field.schema) && !same(valueIn(field, content), field.schema.default ?? null)));
  const { pinion, wheel } = content.pair;
  const parts = modified.map((field) => `${field.words} ${field.wordsFor(at(content, field.path))}`);
  return [`${pinion.teeth}/${wheel.teeth}`, ...parts].join(", ");
}
