/** The access key of a service that asks for one: kept for this tab, until it is closed. */

import { make } from "./elements.js";

const PLACE = "lineofaction-key";
let asking = null;

export function keyHeader() {
  const key = sessionStorage.getItem(PLACE);
  return key ? { Authorization: `Bearer ${key}` } : {};
}

/** Ask for a key, once for all requests that wait for it; resolves to whether there is a new one. */
export function askForKey(reason) {
  asking ??= entered(reason).finally(() => { asking = null; });
  return asking;
}

function entered(reason) {
  return new Promise((done) => {
    const field = make("input", {
      id: "access-key", type: "password", autocomplete: "current-password", required: true, size: 48,
    });
    const form = make(
      "form", { method: "dialog" },
      make("h2", { id: "access-title" }, "Access key"),
      make("p", { id: "access-reason" }, reason),
      make("p", {}, make("label", { for: "access-key" }, "Key "), field),
      make("p", { class: "hint" }, "Whoever runs this service makes one with: loa keys add NAME. It is kept until this tab is closed."),
      make("div", { class: "buttons" },
        make("button", { type: "submit", class: "primary", value: "use" }, "Use this key"),
        make("button", { type: "submit", value: "none", formnovalidate: true }, "Go on without")),
    );
    const dialog = make("dialog", { "aria-labelledby": "access-title", "aria-describedby": "access-reason" }, form);
    dialog.addEventListener("close", () => {
      const key = dialog.returnValue === "use" ? field.value.trim() : "";
      if (key) sessionStorage.setItem(PLACE, key);
      dialog.remove();
      done(Boolean(key));
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}
