// @ts-check
/** Links to parts of the page: they lead there and leave the address alone, which says what is shown. */

import { byId } from "./elements.js";

/** @param {string} id of a part; empty: none */
export function goToSection(id) {
  const part = id ? byId(id) : null;
  part?.scrollIntoView();
  part?.focus({ preventScroll: true });
}

export function sectionLinks() {
  document.addEventListener("click", (event) => {
    const link = /** @type {Element} */ (event.target).closest?.("a[href^='#']");
    const plain = event.button === 0 && !event.ctrlKey && !event.metaKey && !event.shiftKey && !event.altKey;
    if (!link || !plain || event.defaultPrevented) return;
    event.preventDefault();
    goToSection(link.getAttribute("href").slice(1));
  });
}
