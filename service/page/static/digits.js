/** The digits of a number that its error leaves: the one place of the page where a number and its error become text. */

import { number, signed } from "./elements.js";

const SMALLEST_CHANGE = 0.05; // %: smaller ones are rounding of the answers, not an effect of the flanks
const MAX_DIGITS = 7; // of a number whose error is very small

/** Decimals that leave two digits of an error, and at most seven of the number. @param {number} value @param {number} error */
function decimals(value, error) {
  const place = (size, digits) => digits - 1 - Number(size.toExponential(digits - 1).split("e")[1]);
  const last = place(error, 2);
  return Math.max(0, value ? Math.min(last, place(Math.abs(value), MAX_DIGITS)) : last);
}

/** A number as long as its error, or of three digits where that is none (yet). @param {number} value @param {number | null | undefined} error */
export const toError = (value, error) => (
  Number.isFinite(value) && error > 0 ? value.toFixed(Math.min(decimals(value, error), 12)) : number(value, 3));

/** The error behind a number; dots while it is computed. @param {number | null | undefined} error @param {number} value @param {boolean} [coming] */
export function plusMinus(error, value, coming = false) {
  if (!Number.isFinite(error)) return coming ? "± …" : "";
  return `± ${error > 0 ? error.toFixed(Math.min(decimals(value, error), 12)) : "0"}`;
}

/** A number with its error. @param {number} value @param {number | null | undefined} error @param {string} [unit] */
export const withError = (value, error, unit = "") => [toError(value, error), plusMinus(error, value), unit].filter(Boolean).join(" ");

/** Relative change of a figure: "no change" below what the answers resolve. @param {number} value @param {number} from */
export function change(value, from) {
  if (!from || value === from) return "";
  const percent = 100 * (value / from - 1);
  return Math.abs(percent) < SMALLEST_CHANGE ? "no change" : `${signed(percent, Math.abs(percent) < 1 ? 1 : 2)} %`;
}

/** Band of a level, dB, by the error of its amplitude: without end where that is as large; NaN where it is not known. */
export const bandOf = (amplitude, error) => (
  error === undefined || error === null ? NaN : error >= amplitude ? Infinity : -20 * Math.log10(1 - error / amplitude));

/** Change of a level, dB, with its band; "within the errors" where an amplitude is below its error. @param {number} difference @param {number} band @param {boolean} [coming] */
export function levelChange(difference, band, coming = false) {
  if (!difference || !Number.isFinite(difference)) return "";
  if (band === Infinity) return "within the errors";
  const size = Math.abs(difference);
  return `${difference < 0 ? "−" : "+"}${toError(size, band)} ${plusMinus(band, size, coming)}`.trim();
}
