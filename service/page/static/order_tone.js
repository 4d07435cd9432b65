// @ts-check
/** The order map as it sounds where one points: an order as a tone at its frequency there, as loud as the map says. */

import { button, make, number } from "./elements.js";
import { Tone } from "./live_sound.js";
import { linear, nearest } from "./player.js";

const STEP = 0.02; // of the axis by one key
const KEYS = { ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** @typedef {{x: number, order: number}} Place on the axes of a map */

/**
 * What is heard at a place: frequency in Hz, and level in dB below the largest of the map; lower than its depth is silent.
 * @param {any} map trace of plotly.js: its levels stand above the depth @param {{along: number[], mesh_hz: number[]}} track @param {Place} place
 */
export function heardAt({ x, y, z, zmax }, { along, mesh_hz: mesh }, place) {
  const level = z[nearest(y, place.order)][nearest(x, place.x)];
  return { frequency: place.order * linear(along, mesh, place.x), level: level - zmax, part: level > 0 ? 10 ** ((level - zmax) / 20) : 0 };
}

/** A switch and the words of what is heard. @param {any} node plot of the map @param {{title: string, sound: any}} figure */
export function orderTone(node, { title, sound: { tracks: [track] } }) {
  const words = make("output");
  const mark = make("div", { class: "heard-at", hidden: true });
  /** @type {Tone | null} */
  let tone = null;
  /** @type {Place | null} */
  let place = null;

  const axes = () => ["x", "y"].map((letter) => node.layout[`${letter}axis`].range);
  const hear = (/** @type {Place | null} */ next) => {
    const area = node.querySelector(".nsewdrag")?.getBoundingClientRect();
    mark.hidden = !next || !area;
    if (mark.hidden) {
      tone.sound(0, 0);
      return;
    }
    place = next;
    const { frequency, level, part } = heardAt(node.data[0], track, place);
    tone.sound(frequency, part);
    const [[left, right], [low, high]] = axes();
    const frame = node.getBoundingClientRect();
    node.style.position = "relative";
    node.append(mark);
    mark.style.left = `${area.left - frame.left + (area.width * (place.x - left)) / (right - left)}px`;
    mark.style.top = `${area.bottom - frame.top - (area.height * (place.order - low)) / (high - low)}px`;
    const at = `${number(place.x)} ${String(node.layout.xaxis.title.text).split(", ").pop()}`;
    words.textContent = `Order ${number(place.order, 3)} at ${at}: ${number(frequency, 3)} Hz, ${part ? `${Math.round(level) || 0} dB` : "silent"}.`;
  };
  const follow = ({ clientX, clientY }) => {
    const area = node.querySelector(".nsewdrag")?.getBoundingClientRect();
    if (!tone || !area) return;
    const [across, up] = [(clientX - area.left) / area.width, (area.bottom - clientY) / area.height];
    const [[left, right], [low, high]] = axes();
    const within = [across, up].every((part) => part >= 0 && part <= 1);
    hear(within ? { x: left + across * (right - left), order: low + up * (high - low) } : null);
  };
  const step = (event) => {
    const [across, up] = KEYS[event.key] ?? [];
    if (!tone || across === undefined) return;
    event.preventDefault();
    const [[left, right], [low, high]] = axes();
    const within = (value, least, most) => Math.min(Math.max(value, least), most);
    const { x, order } = place ?? { x: 0.5 * (left + right), order: 1 - up };
    hear({ x: within(x + across * (right - left), left, right), order: within(Math.round(order + up), Math.max(1, low), high) });
  };
  const toggle = () => {
    tone?.context.close();
    tone = tone ? null : new Tone(new AudioContext());
    asked.setAttribute("aria-pressed", String(Boolean(tone)));
    mark.hidden = true;
    words.textContent = tone ? "Move over the map, or by the arrow keys." : "";
  };
  const asked = button("Hear orders", toggle, { class: "small", "aria-pressed": "false", "aria-label": `Hear orders of: ${title}`, onkeydown: step });
  node.addEventListener("pointermove", follow, true); // plotly.js takes what moves over its layers
  node.addEventListener("pointerleave", () => tone && hear(null));
  return make("div", { class: "row" }, asked, words);
}
