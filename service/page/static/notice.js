// @ts-check
/** What the first screen says of an address that names nothing here. */

import { byId, make } from "./elements.js";

export function clearNotice() {
  byId("notice").replaceChildren();
}

/** @param {string} text what is not known here, and why that may be */
export function sayUnknown(text) {
  const box = byId("notice");
  if (!box.firstChild) {
    box.append(
      make("strong", {}, "This address names something that is not here."), make("ul"),
      make("p", {}, make("a", { href: "/" }, "Begin anew"), ", or reopen an earlier result from the ",
        make("a", { href: "#jobs" }, "list of jobs"), "."),
    );
  }
  box.querySelector("ul").append(make("li", {}, text));
}
