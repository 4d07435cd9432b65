/** A line across the page while the service does not answer; it goes when the service is back. */

import { get, pause } from "./api.js";
import { byId, make } from "./elements.js";

const EVERY = 2000; // milliseconds

/** @param {() => void} back called when the service answers again */
export function watchService(back) {
  const line = byId("away");
  document.addEventListener("service-away", async () => {
    line.replaceChildren(make("strong", {}, "The service does not answer. "), "Nothing is lost: jobs go on or begin anew "
      + "when it is back, and this page asks for it every few seconds.");
    while (!(await get("/health").then(() => true, () => false))) await pause(EVERY);
  });
  document.addEventListener("service-back", () => {
    line.replaceChildren();
    back();
  });
}
