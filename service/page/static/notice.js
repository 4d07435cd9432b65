// @ts-check
/** What the first screen says of an address that names what cannot be shown. */

import { button, byId, make } from "./elements.js";
import { reveal } from "./tabs.js";

export function clearNotice() {
  byId("notice").replaceChildren();
}

/** @param {string} text what is not shown, and why; or what stands in its place */
export function sayMissing(text) {
  const box = byId("notice");
  if (!box.firstChild) {
    box.append(
      make("strong", {}, "Not all that this address names can be shown."), make("ul"),
      make("p", {}, make("a", { href: "/" }, "Begin anew"), ", or reopen an earlier result from the ",
        button("list of jobs", () => reveal(byId("jobs")), { class: "small" }), "."),
    );
  }
  box.querySelector("ul").prepend(make("li", {}, text));
}
