// @ts-check
/** The result that the address names: its report, its live flanks, its dynamics; and of which design it is. */

import { Problem, get, patiently } from "./api.js";
import { retype, typedIn } from "./controls.js";
import { DesignNote } from "./design_note.js";
import { byId } from "./elements.js";
import { sayMissing } from "./notice.js";
import { fetchPlotly } from "./plotly.js";
import { showReport } from "./report.js";

const PLANE = /plane/;
const OWN = ["live-body", "dynamics-body"]; // parts of the page whose controls belong to one result
const NOTES = ["results-design", "live-design", "dynamics-design"];

export class Results {
  /**
   * @param {object} page
   * @param {import("./address.js").Address} page.address
   * @param {import("./design.js").Design} page.design
   * @param {import("./glance.js").Glance} glance
   * @param {import("./live.js").Live} live
   * @param {{show: (known: object | null) => void}[]} others what is offered for an analyzed pair
   */
  constructor({ address, design }, glance, live, others) {
    Object.assign(this, { address, design, glance, live, others });
    this.key = null;
    this.shown = null;
    this.stopping = new AbortController();
    this.notes = NOTES.map((id) => new DesignNote(byId(id), design));
  }

  /**
   * Show a stored table with what was typed beside it, or nothing.
   * @param {string | null} key
   */
  async show(key) {
    if (key !== this.key) await this.open(key);
    if (this.shown === null || this.shown !== this.address.get("database")) return;
    const { ofResult } = this.address.kept;
    if (ofResult?.key === this.shown) retype(ofResult.fields, ...OWN.map(byId));
    this.live.restored();
  }

  /** @param {string | null} key */
  async open(key) {
    this.stopping.abort();
    this.stopping = new AbortController();
    const { signal } = this.stopping;
    this.key = key;
    this.shown = null;
    if (!key) {
      this.clear();
      return;
    }
    try {
      await this.read(key, signal);
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      if (signal.aborted) return;
      this.key = null;
      this.clear();
      sayMissing(`Result ${key.slice(0, 12)}…: ${problem.message}`);
    }
  }

  /** @param {string} key @param {AbortSignal} signal */
  async read(key, signal) {
    const href = `/v1/results/${key}`;
    fetchPlotly();
    const reported = this.report(href, key, signal);
    reported.catch(() => {}); // said where it is awaited
    const facts = await patiently(() => get(href));
    if (signal.aborted) return;
    const plane = PLANE.test(facts.receipt?.plan?.model ?? "");
    const torques = facts.torque_n_m;
    const known = { key, case: facts.case, torques, torque: torques[Math.floor(torques.length / 2)], plane };
    byId("results-none").hidden = true;
    await reported;
    if (signal.aborted) return;
    this.offer(known);
    this.shown = key;
  }

  /** The report, its main figures first at the top of the page. */
  report(href, hash, signal) {
    const first = (report) => this.glance.show(report);
    return showReport(byId("results-body"), { href, type: "application/x-netcdf", hash }, { making: true, signal, first });
  }

  /** @param {any} known */
  offer(known) {
    this.live.show(known);
    for (const other of this.others) other.show(known);
    for (const note of this.notes) note.of(known?.case ?? null);
  }

  clear() {
    byId("results-none").hidden = false;
    byId("results-body").replaceChildren();
    this.glance.leave();
    this.offer(null);
  }

  /** What is typed in the parts of the result, to be kept with the address. */
  get typed() {
    if (this.shown === null) return this.address.kept.ofResult;
    return { key: this.shown, fields: typedIn(...OWN.map(byId)) };
  }
}
