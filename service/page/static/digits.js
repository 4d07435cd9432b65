/** The digits of a number that its error leaves: the one place of the page where a number and its error become text. */

import { number } from "./elements.js";

/** @type {Record<string, number>} */
const SMALLEST_CHANGE = { "%": 0.05, dB: 0.004 }; // smaller ones are rounding of answers without a stated error
const DIGITS = 4; // of a number without a stated error
const FEW = 3; // of one whose error is computed, or that is indicative
const MAX_DIGITS = 7; // of a number whose error is very small

/**
 * @typedef {object} Estimate
 * @property {string} subject of what the number is: figure, pair, design, operating point
 * @property {number} value
 * @property {number | null} [error] half-width of its band; null: not stated
 * @property {string} [unit]
 * @property {boolean} [coming] whether the error is being computed
 * @property {boolean} [rough] whether it is indicative alone
 * @property {boolean} [size] whether it is an amplitude, which is not known below its error
 */
/** @typedef {{text: string, band: string, data: Record<string, any>}} Printed a number, its error, and both with their subject as attributes of the element */

/** Decimals that leave two digits of an error, and at most seven of the number. @param {number} value @param {number} error */
function decimals(value, error) {
  const place = (size, digits) => digits - 1 - Number(size.toExponential(digits - 1).split("e")[1]);
  const last = place(error, 2);
  return Math.max(0, value ? Math.min(last, place(Math.abs(value), MAX_DIGITS)) : last);
}

/** A number as long as its error, or of as many digits as terminal and report have where none is stated. @param {number} value @param {number | null | undefined} error @param {number} [digits] */
const toError = (value, error, digits = DIGITS) => (
  Number.isFinite(value) && error > 0 ? value.toFixed(Math.min(decimals(value, error), 12)) : number(value, digits));

/** The error behind a number; dots while it is computed. @param {number | null | undefined} error @param {number} value @param {boolean} [coming] */
function plusMinus(error, value, coming = false) {
  if (!Number.isFinite(error)) return coming ? "± …" : "";
  return `± ${error > 0 ? error.toFixed(Math.min(decimals(value, error), 12)) : "0"}`;
}

/** A number with its error. @param {number} value @param {number | null | undefined} error @param {string} [unit] */
export const withError = (value, error, unit = "") => [toError(value, error), plusMinus(error, value), unit].filter(Boolean).join(" ");

/** @param {Estimate} given @param {string} text @param {string} band @param {boolean} below @returns {Printed} */
const printed = ({ subject, value, error, unit }, text, band, below) => ({
  text: text.replace(/^-/, "−"), band,
  data: { "data-subject": subject, "data-value": value, "data-error": error, "data-unit": unit, "data-below": below },
});

/** A number as it is printed; an amplitude below its error is no more than that. @param {Estimate} given @returns {Printed} */
export function estimate(given) {
  const { value, error, unit = "", coming = false, rough = false, size = false } = given;
  const stated = Number.isFinite(error) ? error : null;
  const below = stated !== null && stated >= Math.abs(value);
  if (below && size) return printed({ ...given, error: stated }, `below ${toError(stated, stated)} ${unit}`.trim(), "its error", true);
  return printed({ ...given, error: stated }, `${toError(value, stated, coming || rough ? FEW : DIGITS)} ${unit}`.trim(), plusMinus(stated, value, coming), below);
}

/** A change as it is printed; below its error there is none. @param {Estimate} given of the change @returns {Printed | ""} nothing where nothing changed, or no more than rounding while the error is computed */
export function changeOf(given) {
  const { value, unit = "", coming = false } = given;
  if (!value || !Number.isFinite(value)) return "";
  const error = Number.isFinite(given.error) ? given.error : null;
  const size = Math.abs(value);
  const rounding = error === null && size < (SMALLEST_CHANGE[unit] ?? 0);
  if (rounding && coming) return "";
  const none = rounding || (error !== null && size <= error);
  if (none) return printed({ ...given, error }, `no change${error === null ? "" : ` (± ${toError(error, error)} ${unit})`}`, "", true);
  const digits = error === null ? number(size, size < 1 ? 1 : 2) : toError(size, error);
  const text = `${value < 0 ? "−" : "+"}${digits} ${plusMinus(error, size, coming)}`.trim();
  return printed({ ...given, error }, `${text} ${unit}`.trim(), "", false);
}

/** A level, dB re 1 µm, of an amplitude; of one below its error that of the error. @param {Estimate} given of the amplitude @returns {Printed} */
export function level({ subject, value, error, coming }) {
  const decibels = (size) => 20 * Math.log10(size);
  const given = { subject, value: decibels(value), error: bandOf(value, error), unit: "dB", coming };
  if (given.error !== Infinity) return estimate(given);
  const most = estimate({ ...given, value: decibels(error), error: null, rough: true });
  return { text: `below ${most.text}`, band: "its error", data: { ...most.data, "data-below": true } };
}

/** Band of a level, dB, by the error of its amplitude: without end where that is as large; NaN where it is not known. */
export const bandOf = (amplitude, error) => (
  error === undefined || error === null ? NaN : error >= amplitude ? Infinity : -20 * Math.log10(1 - error / amplitude));
