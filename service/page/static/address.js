// @ts-check
/** The address is the state. Its fragment names what is shown (`#database=HASH&frontier=JOB`), the entry of the browser's
 * history behind it holds what was typed. Reload, back, forward and a new tab show what they say, and nothing else decides. */

export const HASH = /^[0-9a-f]{64}$/;
export const JOB = /^[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$/;
const DESIGN = /^[\w-]+$/; // typed (see packed.js), a job or a result
const VARIANT = /^[\w.-]+$/; // a design, a result and its moved flanks, or a file
const VIEWS = { tab: /^[a-z]+$/, case: DESIGN, live: DESIGN, name: /./, at: /^\d(\.\d+)?$/, motion: /^\d+$/, unit: VARIANT, toml: VARIANT, see: /./, on: /^[abc]$/, a: VARIANT, b: VARIANT, c: VARIANT };
const LEFT = "left";
/** Views of one design and its result. */
export const OF_DESIGN = { case: null, live: null, at: null, motion: null, unit: null, see: null, name: null };

/**
 * @typedef {object} Kept what the entry of the history holds; it goes with the tab, not with the address
 * @property {Record<string, string>} [fields] everything typed, by the id of its control
 * @property {{key: string, fields: Record<string, string>}} [ofResult] the same of the controls that belong to one result
 * @property {{example: string, note: string, replaced?: string}} [origin] what the design began with
 */

export class Address {
  /**
   * @param {string[]} places names of the parts of the page that show jobs
   * @param {() => Kept} typed what is typed now
   */
  constructor(places, typed) {
    this.places = new Set(places);
    this.typed = typed;
    this.read();
    this.kept = left() ?? this.kept;
  }

  /** Read the address and its entry, as they are now. */
  read() {
    /** @type {Kept} */
    this.kept = history.state ?? {};
    /** @type {Map<string, string>} */
    this.names = new Map();
    /** @type {Map<string, string>} */
    this.views = new Map();
    /** @type {string[]} */
    this.faults = [];
    this.section = "";
    const text = location.hash.slice(1);
    if (text && !text.includes("=")) this.section = decoded(text);
    else for (const part of text.split("&").filter(Boolean)) this.readPart(part);
    if (this.section && !document.querySelector(`section#${CSS.escape(this.section)}`)) this.faults.push(this.section);
  }

  /** @param {string} part */
  readPart(part) {
    const [name, value] = part.split("=").map(decoded);
    if (VIEWS[name]?.test(value ?? "")) {
      this.views.set(name, value);
      return;
    }
    const pattern = name === "database" ? HASH : this.places.has(name) ? JOB : null;
    if (pattern?.test(value ?? "")) this.names.set(name, value);
    else this.faults.push(decoded(part));
  }

  /** @param {string} name */
  get(name) {
    return this.names.get(name) ?? null;
  }

  /** Say which tab or design is looked at; null: the usual one. @param {string} name @param {string | null} value */
  look(name, value) {
    if ((this.views.get(name) ?? null) === value) return;
    this.view({ [name]: value });
    this.keep({});
  }

  /** Change views, to be kept with what comes next. @param {Record<string, string | null>} views null: as usual */
  view(views) {
    for (const [name, value] of Object.entries(views)) {
      if (value === this.views.get(name)) continue;
      this.views.delete(name);
      if (value) this.views.set(name, value);
    }
  }

  /**
   * Go on to a new entry of the history; the one that is left keeps what was typed in it.
   * @param {Record<string, string | null>} changes names and what they show now; null: nothing
   */
  push(changes) {
    this.keep(this.typed());
    this.name(changes);
    history.pushState(this.kept, "", this.text);
  }

  /**
   * Change this entry.
   * @param {Record<string, string | null>} changes
   * @param {Kept} [kept]
   */
  replace(changes, kept = {}) {
    this.name(changes);
    this.keep(kept);
  }

  /**
   * Go on to an entry that shows other things of the same address.
   * @param {Record<string, string>} names all of them
   * @param {Record<string, string | null>} views those that change; null: as usual
   * @param {Kept} [kept] what is kept with it; left out: the same
   */
  turn(names, views, kept = this.kept) {
    this.keep(this.typed());
    this.names = new Map(Object.entries(names));
    this.view(views);
    this.kept = kept;
    this.faults = [];
    history.pushState(this.kept, "", this.text);
  }

  /**
   * Let what came of something stand in its place, which says how new its design is.
   * @param {string} name
   * @param {string} successor
   * @param {string} [value] what the successor shows; left out: the same
   */
  settle(name, successor, value = this.names.get(name)) {
    if (!this.names.has(name)) return;
    const others = [...this.names].filter(([other]) => other !== successor);
    this.names = new Map(others.map((part) => (part[0] === name ? [successor, value ?? ""] : part)));
    this.keep({});
  }

  /**
   * Keep something typed with this entry.
   * @param {Kept} kept
   */
  keep(kept) {
    this.kept = { ...this.kept, ...kept };
    history.replaceState(this.kept, "", this.text);
  }

  /** Hold what is typed for a reload: browsers lose the state of an entry that changes while its reload is under way. */
  leave() {
    sessionStorage.setItem(LEFT, JSON.stringify({ ...this.kept, ...this.typed() }));
  }

  /** Name something, the newest last. @param {Record<string, string | null>} changes */
  name(changes) {
    for (const [name, value] of Object.entries(changes)) {
      this.names.delete(name);
      if (value) this.names.set(name, value);
    }
    this.faults = [];
  }

  /** Whether it says nothing at all. */
  get empty() {
    return !this.names.size && !this.section && !this.faults.length && !this.views.has("case") && !this.views.has("unit");
  }

  get text() {
    if (this.faults.length || (this.section && !this.names.size && !this.views.size)) return location.href;
    const fragment = [...this.names, ...this.views].map((pair) => pair.map(encodeURIComponent).join("=")).join("&");
    return `${location.pathname}${location.search}${fragment ? `#${fragment}` : ""}`;
  }
}

/** A part of an address as it was written. @param {string} text */
function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** What the page held when it was left, if a reload brought it back. @returns {Kept | null} */
function left() {
  const text = sessionStorage.getItem(LEFT);
  sessionStorage.removeItem(LEFT);
  const [navigation] = /** @type {PerformanceNavigationTiming[]} */ (performance.getEntriesByType("navigation"));
  return text && navigation.type === "reload" ? JSON.parse(text) : null;
}
