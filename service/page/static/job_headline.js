// @ts-check
/** What came of a job, small: the ripple of its transmission error with its figures, and what it took. */

import { estimate, level, withError } from "./digits.js";
import { draw, duration, figures, make, number } from "./elements.js";
import { torqueWords } from "./live_numbers.js";

/**
 * @typedef {object} Headline as the service keeps it with a result
 * @property {number | null} cpu_seconds
 * @property {number | null} torque_n_m
 * @property {number | null} peak_to_peak_um
 * @property {number | null} peak_to_peak_error_um
 * @property {number | null} first_harmonic_um
 * @property {number | null} [first_harmonic_error_um] null, or none of an older version: not stated
 * @property {number[]} ripple_um over two pitches, both ends in it, less the mean
 */

const WIDTH = 200;
const HEIGHT = 50; // of the drawing, which is stretched to its card

/** @param {Headline | null} found null: nothing is kept @param {string} of which job @returns {(HTMLElement | SVGElement)[]} */
export function headline(found, of) {
  if (!found) return [];
  const list = make("dl", { class: "figures" });
  figures(list, entries(found, of));
  return found.ripple_um.length ? [curve(found), list] : [list];
}

/** @param {Headline} found */
function entries({ cpu_seconds: cpu, torque_n_m: torque, peak_to_peak_um: ripple, peak_to_peak_error_um: error, first_harmonic_um: tone, first_harmonic_error_um: toneError }, of) {
  const point = torque === null ? "" : `at ${torqueWords(torque)}`;
  const entry = (name, remark, given, print = estimate) => {
    const { text, band, data } = print({ ...given, subject: `${name}; ${of}; as computed; ${point}` });
    return [`${name} ${point}`, text, [[band, remark].filter(Boolean).join(" ")], data];
  };
  return [
    ripple !== null && entry("p-p", "", { value: ripple, error, unit: "µm" }),
    tone && entry("harmonic 1", "re 1 µm", { value: tone, error: toneError }, level),
    cpu !== null && ["CPU time", cpu < 90 ? `${number(cpu, 2)} s` : duration(cpu)],
  ].filter(Boolean);
}

/** @param {Headline} found */
function curve({ ripple_um: values, peak_to_peak_um: size, peak_to_peak_error_um: error }) {
  const most = Math.max(...values.map(Math.abs)) || 1;
  const high = (value) => (HEIGHT / 2) * (1 - 0.94 * (value / most));
  const points = values.map((value, k) => `${((WIDTH * k) / (values.length - 1)).toFixed(1)},${high(value).toFixed(1)}`);
  const label = `Ripple of the transmission error over two base pitches, ${withError(size, error, "µm")} peak to peak`;
  const facts = { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", role: "img", "aria-label": label };
  const drawing = draw("svg", facts);
  drawing.append(
    draw("line", { class: "ripple zero", x1: 0, x2: WIDTH, y1: HEIGHT / 2, y2: HEIGHT / 2 }),
    draw("polyline", { class: "ripple", points: points.join(" ") }),
  );
  return drawing;
}
