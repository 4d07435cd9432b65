// @ts-check
/** The layout: rail and dock fold, the stage is split between the thing and the curve, keys of the whole page. */

import { byId } from "./elements.js";
import { Tabs, reveal } from "./tabs.js";

const NARROW = window.matchMedia("(max-width: 62rem)"); // rail and dock are sheets from below
const SIDES = ["rail", "dock"];
const STEP = 5; // per cent of the split by one key

/** Lay the page out; `tabbed` is told which tab of the stage is shown. @param {(id: string) => void} tabbed */
export function layOut(tabbed) {
  for (const name of SIDES) foldable(name);
  split();
  document.querySelector(".skip").addEventListener("click", (event) => {
    event.preventDefault(); // the address says what is shown
    reveal(byId("rail"));
    byId("rail").focus();
  });
  document.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) byId("analyze").click();
    if (event.key === "Escape" && NARROW.matches) for (const name of SIDES) fold(name, false);
  });
  NARROW.addEventListener("change", () => SIDES.forEach((name) => fold(name, !NARROW.matches)));
  return new Tabs(byId("tabs"), byId("panels"), tabbed);
}

/** @param {string} name */
function foldable(name) {
  byId(`${name}-fold`).addEventListener("click", () => fold(name, byId(name).hidden));
  byId(name).addEventListener("reveal", () => fold(name, true));
  fold(name, !NARROW.matches);
}

/** @param {string} name @param {boolean} open */
function fold(name, open) {
  if (open && NARROW.matches) for (const other of SIDES) if (other !== name) fold(other, false);
  byId(name).hidden = !open;
  byId(`${name}-fold`).setAttribute("aria-expanded", String(open));
}

/** The bar between the thing and the curve: dragged, moved by arrows, one of both made whole by a double click. */
function split() {
  const bar = byId("split");
  const put = (/** @type {number} */ share) => {
    const value = Math.round(Math.min(Math.max(share, 0), 100));
    bar.setAttribute("aria-valuenow", String(value));
    bar.parentElement.style.setProperty("--upper", `${value}fr`);
    bar.parentElement.style.setProperty("--lower", `${100 - value}fr`);
  };
  const now = () => Number(bar.getAttribute("aria-valuenow"));
  bar.addEventListener("pointerdown", (event) => bar.setPointerCapture(event.pointerId));
  bar.addEventListener("pointermove", (event) => {
    if (!bar.hasPointerCapture(event.pointerId)) return;
    const { top, bottom } = bar.parentElement.getBoundingClientRect();
    const begin = byId("thing").getBoundingClientRect().top;
    put((100 * (event.clientY - begin)) / (bottom - Math.max(begin, top)));
  });
  bar.addEventListener("dblclick", () => put(now() >= 50 && now() < 100 ? 100 : now() === 100 ? 0 : 50));
  bar.addEventListener("keydown", (event) => {
    const step = { ArrowUp: -STEP, ArrowDown: STEP, Home: -100, End: 100 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    put(now() + step);
  });
}
