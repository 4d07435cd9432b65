// @ts-check
/** The flank of a picked tooth as a map: pressure over face (across) and roll length (tip above), the place marked. */

import { make } from "./elements.js";

const SIZE = { width: 160, height: 64 };
const CIVIDIS = [[0, 34, 78], [87, 92, 109], [187, 174, 114], [255, 233, 69]];
const AT = [0, 0.4, 0.8, 1];

/** @param {number} part of the scale @returns {number[]} red, green, blue */
function colored(part) {
  const k = AT.findIndex((end, index) => index > 0 && part <= end) || AT.length - 1;
  const share = (part - AT[k - 1]) / (AT[k] - AT[k - 1]);
  return CIVIDIS[k].map((value, i) => value * share + CIVIDIS[k - 1][i] * (1 - share));
}

/**
 * @param {{pressure: (across: number, up: number) => number, top: number, across: number, up: number, words: string}} flank
 *   pressure in MPa by place, both from 0 to 1; the picked place
 */
export function flankMap({ pressure, top, across, up, words }) {
  const canvas = /** @type {HTMLCanvasElement} */ (make("canvas", { ...SIZE, class: "view-flank", role: "img", "aria-label": words }));
  const context = canvas.getContext("2d");
  const image = context.createImageData(SIZE.width, SIZE.height);
  for (let y = 0; y < SIZE.height; y += 1) {
    for (let x = 0; x < SIZE.width; x += 1) {
      const value = pressure((x + 0.5) / SIZE.width, 1 - (y + 0.5) / SIZE.height);
      image.data.set([...colored(Math.min(value / top, 1)), value > 0 ? 255 : 40], 4 * (y * SIZE.width + x));
    }
  }
  context.putImageData(image, 0, 0);
  context.strokeStyle = "#d5003a";
  context.lineWidth = 2;
  context.beginPath();
  context.arc(across * SIZE.width, (1 - up) * SIZE.height, 5, 0, 2 * Math.PI);
  context.stroke();
  return canvas;
}
