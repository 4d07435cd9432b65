// @ts-check
/** Tabs over or beside their panels: one stop of the keyboard, from which arrows go on. */

import { button } from "./elements.js";

const STEPS = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1, Home: -Infinity, End: Infinity };

export class Tabs {
  /**
   * @param {HTMLElement} list of the tabs
   * @param {HTMLElement} panels holds the panels, each with its title in `data-title`
   * @param {(id: string) => void} [chosen] called when another panel is shown
   */
  constructor(list, panels, chosen = () => {}) {
    Object.assign(this, { list, panels, chosen });
    list.addEventListener("keydown", (event) => this.key(event));
    panels.addEventListener("reveal", (event) => this.select(/** @type {Element} */ (event.target).id));
    this.renew();
  }

  /** Offer the panels that are there now. */
  renew() {
    const all = /** @type {HTMLElement[]} */ ([...this.panels.children]).filter(({ dataset }) => dataset.title);
    this.tabs = new Map(all.map((panel) => [panel.id, { panel, tab: this.tab(panel) }]));
    this.list.replaceChildren(...[...this.tabs.values()].map(({ tab }) => tab));
    this.select(this.tabs.has(this.shown) ? this.shown : all[0].id);
  }

  /** @param {HTMLElement} panel */
  tab(panel) {
    const id = `${panel.id}-tab`;
    panel.setAttribute("role", "tabpanel");
    panel.setAttribute("aria-labelledby", id);
    const facts = { role: "tab", id, "aria-controls": panel.id, "data-level": panel.dataset.level, "data-of": panel.dataset.of };
    return button(panel.dataset.title, () => this.select(panel.id), facts);
  }

  /** @param {string} id of a panel; of none: the one that is shown stays */
  select(id) {
    if (!this.tabs.has(id)) return;
    const before = this.shown;
    this.shown = id;
    for (const [name, { panel, tab }] of this.tabs) {
      panel.hidden = name !== id;
      tab.setAttribute("aria-selected", String(name === id));
      tab.tabIndex = name === id ? 0 : -1;
    }
    if (before && before !== id) this.chosen(id);
  }

  /** Leave a tab that the subject does not have. @param {string} subject @param {string} usual */
  of(subject, usual) {
    const { of = subject } = this.tabs.get(this.shown).panel.dataset;
    if (of !== subject) this.select(usual);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (!(event.key in STEPS)) return;
    event.preventDefault();
    const names = [...this.tabs].filter(([, { tab }]) => tab.offsetWidth).map(([name]) => name);
    const at = Math.min(Math.max(names.indexOf(this.shown) + STEPS[event.key], 0), names.length - 1);
    this.select(names[at]);
    this.tabs.get(names[at]).tab.focus();
  }
}

/** Unfold whatever hides a part of the page. @param {Element | null} node */
export function reveal(node) {
  for (let each = node; each; each = each.parentElement) {
    if (each instanceof HTMLDetailsElement) each.open = true;
    if (each.matches("[role=tabpanel], .side")) each.dispatchEvent(new Event("reveal", { bubbles: true }));
  }
}
