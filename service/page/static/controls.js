// @ts-check
/** What is typed on the page, by the id of its control. */

const CONTROLS = ":is(input, select, textarea)[id]:not([type=file], [type=password], [data-unkept])";

/** @typedef {HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement} Control */

/** @param {Element[]} roots @returns {Control[]} */
const controlsIn = (roots) => roots.flatMap((root) => /** @type {Control[]} */ ([...root.querySelectorAll(CONTROLS)]));

/** @param {Element[]} roots @returns {Record<string, string>} */
export function typedIn(...roots) {
  return Object.fromEntries(controlsIn(roots).map(({ id, value }) => [id, value]));
}

/** @param {Record<string, string>} fields @param {Element[]} roots */
export function retype(fields, ...roots) {
  for (const control of controlsIn(roots)) if (control.id in fields) control.value = fields[control.id];
}
