// @ts-check
/** The result that the address names: its report, its live flanks, its dynamics; and of which design it is. */

import { get, guarded, patiently } from "./api.js";
import { retype, typedIn } from "./controls.js";
import { DesignNote } from "./design_note.js";
import { byId, figures, folded, make } from "./elements.js";
import { sayMissing } from "./notice.js";
import { pack, unpack } from "./packed.js";
import { fetchPlotly } from "./plotly.js";
import { circlesOf } from "./relief_start.js";
import { leadOf, showReport } from "./report.js";

const PLANE = /plane/;
const LONGEST = 256; // base pitches over which curves follow sliders
const OWN = ["live-body", "quick", "dynamics-body"]; // parts of the page whose controls belong to one result
const TABS = { // where the figures of the report stand; those of no other tab are with the tables
  ripple: ["ste", "ripple", "ripple_over_torque"], flank: ["flanks_over_torque", "face_load", "pair_drawing"],
  load: ["load_sharing", "mesh_stiffness"], orders: ["ste_spectrum", "harmonics"],
};
const PLACES = new Map(Object.entries(TABS).flatMap(([tab, keys]) => keys.map((key) => [key, `report-${tab}`])));

export class Results {
  /**
   * @param {object} page
   * @param {import("./address.js").Address} page.address
   * @param {import("./design.js").Design} page.design
   * @param {import("./live.js").Live} live
   * @param {{show: (known: object | null) => void}[]} others what is offered for an analyzed pair
   */
  constructor({ address, design }, live, others) {
    Object.assign(this, { address, design, live, others });
    this.key = undefined; // nothing was shown yet
    this.shown = null;
    this.stopping = new AbortController();
    this.note = new DesignNote(byId("results-design"), design);
    for (const tab of Object.keys(TABS)) {
      const report = folded("As analyzed", make("div", { id: `report-${tab}`, class: "report" }));
      byId(tab).prepend(make("div", { class: "live", id: `live-${tab}` }), report);
    }
    document.addEventListener("another", () => this.leave());
  }

  /**
   * Show a stored table with what was typed beside it, or nothing.
   * @param {string | null} key
   */
  async show(key) {
    if (key !== this.key) await this.open(key);
    if (!this.stands) return;
    this.retype();
    document.dispatchEvent(new Event("opened"));
    await this.live.restored();
  }

  /** Another design was opened, not edited: unless the result is of it, it stays behind in the history. */
  leave() {
    if (this.key === null || !this.design.edits(this.note.content).length) return;
    this.address.replace({ database: null }, {});
    this.show(null);
  }

  /** Whether the result of the address is the one that is shown. */
  get stands() {
    return this.shown !== null && this.shown === this.address.get("database");
  }

  /** Put its controls where the address or its entry has them. */
  retype() {
    const { ofResult } = this.address.kept;
    if (ofResult?.key === this.shown) retype(ofResult.fields, ...OWN.map(byId));
    else this.live.sliders.moved = unpack(this.address.views.get("live") ?? "");
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
    await guarded(() => this.read(key, signal), (problem) => {
      if (signal.aborted) return;
      this.key = null;
      this.clear();
      sayMissing(`Result ${key.slice(0, 12)}…: ${problem.message}`);
    });
  }

  /** Say that a result is being read. */
  announce() {
    byId("results-none").hidden = true;
    byId("dock-words").textContent = "The result of this address is being read.";
  }

  /** @param {string} key @param {AbortSignal} signal */
  async read(key, signal) {
    const href = `/v1/results/${key}`;
    fetchPlotly();
    const reported = this.report(href, key, signal);
    reported.catch(() => {}); // said where it is awaited
    this.announce();
    const facts = await patiently(() => get(href));
    if (signal.aborted) return;
    const plane = PLANE.test(facts.receipt?.plan?.model ?? "");
    const torques = facts.torque_n_m;
    const long = facts.period > LONGEST;
    const circles = await circlesOf(facts.case);
    if (signal.aborted) return;
    const known = { key, case: facts.case, circles, torques, plane, long };
    const report = await reported;
    if (signal.aborted) return;
    this.offer(known);
    figures(byId("live-figures"), (report?.headlines ?? []).map(({ name, value, remark }) => [name, value, remark])); // until sliders have theirs
    if (long) this.asAnalyzed(facts.period);
    this.shown = key;
  }

  /** The report: its figures in the tabs, its warnings in the dock. */
  async report(href, hash, signal) {
    const place = (key) => byId(PLACES.get(key) ?? "");
    const result = { href, type: "application/x-netcdf", hash };
    this.unreport();
    const report = await showReport(byId("results-body"), result, { making: true, signal, place, alarms: byId("results-alarms") });
    if (report) byId("dock-words").textContent = leadOf(report);
    return report;
  }

  /** Show all as analyzed where no curves follow sliders. @param {number} period */
  asAnalyzed(period) {
    for (const tab of Object.keys(TABS)) byId(`report-${tab}`).parentElement.open = true;
    byId("dock-words").append(` Over ${period} base pitches curves are as analyzed: sliders take at most ${LONGEST}.`);
  }

  /** Show what the first example gave when the program was made: nothing is computed. @param {{title: string, curve: any, case: object, outline: any}} came */
  async still({ title, curve, case: content, outline }) {
    byId("results-none").hidden = true;
    byId("dock-words").textContent = `${title}. These results came with the program. Once you press Analyze, they are computed here and the sliders answer.`;
    this.key = ""; // it has none
    this.note.of(content);
    await this.live.still(curve, outline, content);
  }

  unreport() {
    for (const id of ["results-body", "results-alarms", "dock-words", ...PLACES.values()]) byId(id).replaceChildren();
  }

  /** @param {any} known */
  offer(known) {
    this.live.show(known);
    for (const other of this.others) other.show(known);
    this.note.of(known?.case ?? null);
  }

  clear() {
    byId("results-none").hidden = false;
    this.unreport();
    this.offer(null);
  }

  /** Where its sliders stand, as a word of the address; null: as analyzed. */
  get moved() {
    if (this.shown === null) return this.address.views.get("live") ?? null;
    const { torque_n_m: torque, misalignment_um: misaligned, pinion, wheel } = this.live.sliders.moved;
    const same = torque === undefined && !misaligned && !Object.keys({ ...pinion, ...wheel }).length;
    return same ? null : pack(this.live.sliders.moved);
  }

  /** What is typed in the parts of the result, to be kept with the address. */
  get typed() {
    if (this.shown === null) return this.address.kept.ofResult;
    return { key: this.shown, fields: typedIn(...OWN.map(byId)) };
  }
}
