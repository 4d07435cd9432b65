// @ts-check
/** A line that says of which design a result is, once the design has been edited since; and the way back to it. */

import { button, make } from "./elements.js";

const MOST = 6; // differences that are written out

export class DesignNote {
  /** @param {HTMLElement} node @param {import("./design.js").Design} design */
  constructor(node, design) {
    this.node = node;
    this.design = design;
    this.content = null;
    design.watch(() => this.refresh());
  }

  /** @param {object | null} content the case of the result; null: nothing is known of it */
  of(content) {
    this.content = content;
    this.refresh();
  }

  refresh() {
    const changes = this.content ? this.design.edits(this.content) : [];
    const text = changes.length ? sentence(this.content, changes) : "";
    if (text === this.said) return;
    this.said = text;
    this.node.replaceChildren(...(text ? [this.block(text)] : []));
  }

  block(text) {
    const back = () => this.design.goTo(this.content, "Back to the design of the result.");
    return make(
      "div", { class: "design-note", role: "note" }, make("p", {}, text),
      button("Back to that design", back, { class: "small" }),
    );
  }
}

/** @param {any} content @param {import("./comparison.js").Difference[]} changes */
function sentence({ pair }, changes) {
  const shown = changes.map(({ text }) => text).filter(Boolean).slice(0, MOST);
  const more = changes.length > shown.length ? `, and ${changes.length - shown.length} more` : "";
  return `Result of the design ${pair.pinion.teeth}/${pair.wheel.teeth}, module ${pair.normal_module_mm} mm, as computed. `
    + `Edited since: ${shown.join(", ")}${more}.`;
}
