/** Live flanks: sliders redraw the transmission error from the compliance the service keeps. */

import { Problem, ask, pause, post } from "./api.js";
import { heardIn } from "./complaint.js";
import { withError } from "./digits.js";
import { button, byId, dataTable, figures, folded, make } from "./elements.js";
import { SHOWN_HARMONICS, harmonicsFigure, sharingFigure, steFigure, strongestOrders } from "./live_figures.js";
import { faultsOf } from "./job.js";
import { LiveFlanks, liveBlock } from "./live_flanks.js";
import { besideFigures, heardFigures, mainFigures, numbersOf, ordersOf, pointWords, sourcesOf, spokenFigures } from "./live_numbers.js";
import { LiveSound } from "./live_sound.js";
import { MadeBand } from "./made_band.js";
import { plot } from "./plots.js";
import { Sliders } from "./sliders.js";
import { TorqueCurve } from "./torque_curve.js";
import { reveal } from "./tabs.js";
import { Other, UNMOVED } from "./variants.js";

const STYLES = {
  before: { name: "as analyzed", color: "#767676", width: 1.8, dash: "dash" },
  now: { name: "now", color: "#0072B2", width: 2.4, dash: "solid" },
  a: { name: "A", color: "#0072B2", width: 2.4, dash: "solid" },
  b: { name: "B", color: "#D55E00", width: 2.4, dash: "solid" },
  c: { name: "C", color: "#009E73", width: 2.4, dash: "solid" },
};
const PLACES = { ste: "live-ripple", harmonics: "live-orders", sharing: "live-load", flanks: "live-flank", sound: "live-sound" };
const REST = 150; // milliseconds without a move after which sliders are taken to rest
const AWAY = 2; // seconds after which a service that does not answer is asked again

/** Curves of the complaint whose last is under way. @param {any} heard */
const coming = ({ curves, ...heard }) => ({ ...heard, curves: curves.map((own, k) => (k < curves.length - 1 ? own : { ...own, curve: { ...own.curve, preview: true } })) });

/** The torque that all views begin with: the complaint's, or the middle load. @param {any} content the design @param {number[]} torques of its table */
function usualTorque(content, torques) {
  const { order, torque } = heardIn(content);
  return Number.isFinite(order) && torque > 0 && torque <= 2 * torques.at(-1) ? torque : torques[Math.floor(torques.length / 2)];
}

/** A pair by its teeth. @param {{case: any}} known */
const pairOf = ({ case: { pair } }) => `${pair.pinion.teeth}/${pair.wheel.teeth}`;

export class Live {
  /**
   * @param {object} page
   * @param {import("./design.js").Design} page.design
   * @param {import("./variants.js").Variants} page.variants
   * @param {string} page.caller by whom curves are asked for
   * @param {{take: (flanks: object) => void, inThreeDimensions: () => void}} actions
   */
  constructor({ design, variants, caller }, actions) {
    Object.assign(this, { design, variants, caller, actions });
    this.others = [];
    this.waiting = null;
    this.busy = false;
    document.addEventListener("marked", () => {
      this.sound?.mark();
      this.ask();
    });
    design.watch(() => this.retorque());
    byId("operating-point").addEventListener("click", () => this.atTorque());
  }

  /**
   * Begin with the result of an analysis, or with none; `restored` draws it.
   * @param {{key: string, case: object, torques: number[], plane: boolean} | null} known
   */
  show(known) {
    clearTimeout(this.resting);
    Object.assign(this, { before: null, waiting: null, shown: null, rested: null, sound: null });
    byId("live-none").hidden = known !== null;
    byId("live-body").hidden = byId("quick").hidden = !known || known.long;
    this.known = known && { ...known, highest: known.torques.at(-1), torque: usualTorque(this.design.case, known.torques) };
    this.analyzed = known && new Other("before", known, UNMOVED);
    this.heard = null;
    byId("operating-point").hidden = true;
    this.mark(false);
    for (const id of ["live-figures", "compared", "sliders", "quick", ...Object.values(PLACES)]) byId(id).replaceChildren(); // of another result
    this.design.view.press(null);
    if (known) this.controls();
    if (known && !known.long) this.plots();
  }

  /** Show a curve that came with the program, on its pair. @param {any} curve @param {any} outline @param {any} content its case */
  async still(curve, outline, content) {
    this.design.view.press(curve, outline);
    this.plots();
    await this.plot([{ ...STYLES.now, curve, pair: pairOf({ case: content }) }], { still: true });
  }

  /** Follow the torque of the complaint, where nobody moved the slider. */
  retorque() {
    const torque = this.known && usualTorque(this.design.case, this.known.torques);
    if (!this.known || torque === this.known.torque) return;
    const stands = this.sliders.value("torque_n_m") === this.known.torque;
    this.known.torque = torque;
    this.sliders.stand("torque_n_m", torque, stands);
    if (stands) this.ask();
  }

  /** Let the torque of the curves be typed. */
  atTorque() {
    const exact = byId("live-torque_n_m-exact");
    if (!exact) return;
    reveal(exact);
    exact.select();
  }

  /** Say in the dock at which operating point its numbers are. @param {any} curve */
  named(curve) {
    const point = byId("operating-point");
    point.hidden = false;
    point.textContent = this.at(curve);
    point.disabled = !this.known;
    return point.textContent;
  }

  /** The operating point of a curve, with the speed of the complaint. @param {any} curve */
  at(curve) {
    const { driver } = heardIn(this.design.case);
    return `${pointWords(curve)}${driver > 0 ? `, ${Number(driver.toPrecision(4))} rpm` : ""}`;
  }

  /** The sliders stand where the address left them: draw that. */
  async restored() {
    this.others = await this.variants.others();
    this.sliders.told();
    this.ask();
  }

  controls() {
    this.sliders = new Sliders(this.known, [...this.design.fields], () => this.ask());
    this.torques = new TorqueCurve(2 * this.known.highest, this.caller, () => this.again(), (torque) => this.sliders.put("torque_n_m", torque));
    this.sliders.block("torque_n_m").append(this.torques.node);
    const note = this.known.plane ? make(
      "div", {},
      make("p", { class: "hint" }, "Computed in the plane: misalignment, crowning and all else that acts across the face need three dimensions."),
      button("Analyze in three dimensions", () => this.actions.inThreeDimensions()),
    ) : null;
    byId("sliders").replaceChildren(
      ...this.sliders.blocks, note ?? "",
      make(
        "div", { class: "buttons" },
        button("As analyzed", () => this.sliders.reset()),
        button("Take these flanks into the case", () => this.actions.take(this.sliders.flanks)),
      ),
    );
    byId("quick").replaceChildren();
    this.sliders.follow(byId("quick"));
  }

  /** Ask for where the sliders are now; while an answer is on its way only the newest wish is kept. @param {boolean} [preview] as they move */
  async ask(preview = true) {
    clearTimeout(this.resting);
    if (!this.known || this.known.long) return;
    this.mark(true);
    this.waiting = { ...this.sliders.moved, torque_n_m: [this.sliders.value("torque_n_m")], preview };
    await this.work();
  }

  /** Say that the numbers are of before, until those of now are there with their errors. @param {boolean} now */
  mark(now) {
    for (const id of ["live-figures", "compared"]) byId(id).setAttribute("aria-busy", String(now));
  }

  /** Answer what is waited for, then what a hand at rest leaves time for. */
  async work() {
    if (this.busy) return;
    this.busy = true;
    try {
      while ((this.waiting || this.rested) && this.known) await this.next();
    } finally {
      this.busy = false;
    }
  }

  /** What takes longer than a slider may wait, of curves at rest. @param {any[]} shown @param {string} key */
  async rest(shown, key) {
    const moved = () => Boolean(this.waiting) || key !== this.known?.key;
    await this.torques.follow(shown, moved);
    await this.made.follow(shown, moved);
    if (!moved()) await plot(this.blocks.ste.node, this.ripple(shown));
  }

  /** Begin again with what a hand at rest leaves time for, as something of it is switched on or seen. */
  again() {
    this.rested = this.shown;
    this.work();
  }

  async next() {
    const { waiting, rested } = this;
    this.waiting = null;
    this.rested = null;
    const key = this.known.key;
    try {
      if (!waiting) {
        await this.rest(rested, key);
        return;
      }
      const begin = performance.now();
      await this.baseline(waiting, key);
      const others = [];
      for (const other of this.others) {
        const curve = await other.at(waiting.torque_n_m[0], this.caller);
        if (curve) others.push({ ...STYLES[other.name], curve, known: other.known, pair: pairOf(other.known), asked: { key: other.known.key, flanks: other.flanks } });
      }
      const found = await ask(`${key}/ste`, { ...waiting, flanks: true, passage: true, caller: this.caller });
      const round = performance.now() - begin;
      if (key !== this.known?.key) return;
      const now = { ...found.curves[0], preview: waiting.preview };
      const shown = this.beside(now, others, { key, flanks: { ...waiting, torque_n_m: undefined, preview: undefined } });
      this.heard = await this.complained(now, waiting);
      if (key !== this.known?.key) return;
      this.roll(now);
      await this.draw(shown);
      this.timed(round, performance.now() - begin, found, waiting.preview ? "previews" : "answers");
      if (waiting.preview && !this.waiting) this.resting = setTimeout(() => this.ask(false), REST);
      byId("live-errors").hidden = true;
      this.shown = waiting.preview ? null : shown;
      if (!waiting.preview && !this.waiting) this.mark(false);
      this.rested = this.shown;
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      if (problem.type.endsWith("superseded") || key !== this.known?.key) return;
      if (problem.status !== 0) this.refuse(problem); // the line across the page says it
      const wait = problem.retryAfter || (problem.status === 0 ? AWAY : 0);
      if (!wait) this.mark(false);
      if (!wait) return;
      await pause(1000 * wait); // busy or away: ask again, for what is wanted by then
      this.waiting ??= waiting;
      this.rested ??= rested;
    }
  }

  /** The curves at the torque of the complaint, the last as the flanks are now; null: it is no harmonic. @param {any} now @param {any} waiting */
  async complained(now, waiting) {
    const { harmonic, torque } = heardIn(this.design.case);
    if (!harmonic || harmonic > now.harmonics_um.length || !(torque > 0)) return null;
    const [caller, slider] = [`${this.caller}-complaint`, torque === waiting.torque_n_m[0]];
    const same = this.heard?.harmonic === harmonic && this.heard.torque === torque;
    if (waiting.preview && !slider && same) return coming(this.heard); // it is a request of its own: at rest
    const own = slider ? now : await new Other("now", this.known, waiting).at(torque, caller);
    const compared = this.others.length ? this.others : [this.analyzed];
    const curves = await Promise.all(compared.map(async (other) => ({ ...STYLES[other.name], pair: pairOf(other.known), curve: await other.at(torque, caller) })));
    const last = { ...STYLES[this.others.length ? this.variants.on : "now"], pair: pairOf(this.known), curve: own && { ...own, preview: waiting.preview } };
    return { harmonic, torque, curves: [...curves, last].filter(({ curve }) => curve) };
  }

  /** The curve as analyzed at this torque, to compare with. */
  async baseline({ torque_n_m: torque, preview }, key) {
    if (this.before?.asked === torque[0] && this.before.key === key && (preview || !this.before.preview)) return;
    const found = await ask(`${key}/ste`, { torque_n_m: torque, preview, flanks: true, caller: `${this.caller}-before` });
    this.before = { ...found.curves[0], key, asked: torque[0], preview };
  }

  /** Pressure on the pair that rolls. @param {any} curve */
  async roll(curve) {
    const { known } = this;
    known.outline ??= post("/v1/cases/outline", { inputs: { case: known.case } });
    const outline = await known.outline;
    if (known === this.known) this.design.view.press(curve, outline);
  }

  refuse(problem) {
    const box = byId("live-errors");
    box.replaceChildren(faultsOf(problem));
    box.hidden = false;
  }

  timed(round, all, found, count) {
    const said = [`Answered in ${round.toFixed(0)} ms, drawn after ${all.toFixed(0)} ms.`];
    if (found.beyond_load_patches) {
      said.push(`At ${found.beyond_load_patches} points the contact is wider than the mesh allows for.`);
    }
    const broken = (found.assumptions ?? []).filter(({ holds }) => holds === false);
    said.push(...broken.map(({ assumption, reason }) => `Violated: ${assumption} (${reason}).`));
    byId("live-time").textContent = said.join(" ");
    const body = byId("live-figures").dataset;
    Object.assign(body, { answered: round.toFixed(1), milliseconds: all.toFixed(1), cpu: found.cpu_seconds });
    body[count] = Number(body[count] || 0) + 1;
  }

  plots() {
    this.blocks = {
      ste: liveBlock("live_ste", "Transmission error", `Gray${this.known ? "" : ", after Analyze"}: the pair as analyzed, at the same torque and aligned.`),
      harmonics: liveBlock("live_harmonics", "Mesh harmonics", "Amplitudes of the mesh frequency and its multiples."),
      sharing: liveBlock("live_load_share", "Load sharing", "Part of the load on each pair of teeth."),
    };
    this.numbers = folded("Numbers");
    this.made = new MadeBand(this.known?.case, this.caller, () => this.again());
    this.made.node.hidden = !this.known;
    this.blocks.ste.block.append(this.made.node, this.numbers);
    this.flanks = new LiveFlanks();
    this.sound = new LiveSound();
    for (const [name, { block: shown }] of Object.entries(this.blocks)) byId(PLACES[name]).replaceChildren(shown);
    byId(PLACES.flanks).replaceChildren(...this.flanks.blocks);
  }

  /** Curves as they are drawn: as analyzed, those of other variants, in front that of the sliders. */
  beside(now, others, asked) {
    const pair = pairOf(this.known);
    const own = { ...STYLES[others.length ? this.variants.on : "now"], pair, curve: now, asked };
    return [{ ...STYLES.before, pair, curve: this.before, asked: { ...asked, flanks: UNMOVED } }, ...others, own];
  }

  async draw(shown) {
    this.sound.show(shown.map(({ name, curve, known = this.known }) => (
      { name, teeth: known.case.pair.pinion.teeth, harmonics: curve.harmonics_um.filter(Number.isFinite) })));
    this.torques.draw(shown);
    await this.plot(shown);
  }

  /** Plot curves, the last with its figures and their change from the first. @param {object[]} shown @param {object} [facts] of the first plot */
  plot(shown, facts = {}) {
    const { curve } = shown.at(-1);
    const point = this.named(curve);
    const alone = shown.length < 3;
    figures(byId("live-figures"), alone ? [...heardFigures(this.heard), ...mainFigures(shown.at(-1), shown[0])] : []);
    const refused = this.others.filter((other) => other.refused).map((other) => make("p", { class: "hint" }, other.refused));
    byId("compared").replaceChildren(...(alone ? [] : [dataTable(besideFigures(shown.slice(1), this.heard)).firstChild]), ...refused);
    this.describe(shown, point);
    return Promise.all([
      plot(this.blocks.ste.node, { ...this.ripple(shown), ...facts }),
      plot(this.blocks.harmonics.node, harmonicsFigure(shown, this.count(curve))),
      plot(this.blocks.sharing.node, sharingFigure(curve)),
      this.flanks.draw(shown, point),
    ]);
  }

  /** The curves, in front of the bands of pairs as made. */
  ripple(shown) {
    return steFigure(shown, this.made.traces(shown));
  }

  /** Say over how many pitches a curve goes, at which operating point, and which orders it has. @param {any} curve @param {string} point */
  entitle({ period }, point) {
    const words = period > 1
      ? [`Transmission error over ${period} base pitches`, "Orders of teeth that differ",
        "Of the mesh (mesh 1), of a shaft (pinion 1: its run-out; pinion 11: 11 waves, a ghost order), and sidebands (mesh 1 - pinion 1)."]
      : ["Transmission error over two base pitches", "Mesh harmonics", "Amplitudes of the mesh frequency and its multiples."];
    const { ste, harmonics, sharing } = this.blocks;
    ste.block.querySelector("h3").textContent = `${words[0]}, ${point}`;
    harmonics.block.querySelector("h3").textContent = `${words[1]}, ${point}`;
    sharing.block.querySelector("h3").textContent = `Load sharing, ${point}`;
    harmonics.block.querySelector("figcaption").textContent = words[2];
  }

  /** How many harmonics are shown of a curve: up to that of the complaint, if it has that. @param {any} curve */
  count({ harmonics_um: { length } }) {
    const { harmonic } = heardIn(this.design.case);
    return harmonic && harmonic <= length ? Math.max(SHOWN_HARMONICS, harmonic) : SHOWN_HARMONICS;
  }

  describe(shown, point) {
    const now = shown.at(-1).curve;
    const count = this.count(now);
    const tables = [numbersOf(shown, count), ...(now.period > 1 ? [ordersOf(shown.at(-1))] : []), sourcesOf(shown.at(-1))];
    const numbers = tables.map((table) => dataTable(table));
    this.numbers.replaceChildren(make("summary", {}, "Numbers"), ...numbers);
    this.entitle(now, point);
    const spoken = shown.map((own) => ({ name: own.name, ...spokenFigures(own, count) })).reverse();
    const ripples = spoken.map(({ name, ripple }) => `${name} ${ripple}`).join(", ");
    this.blocks.ste.node.setAttribute("aria-label", `Transmission error ${point}: peak to peak ${ripples}; mean ${spoken[0].mean} now.`);
    const tones = now.period > 1
      ? `Strongest orders: ${strongestOrders(now, SHOWN_HARMONICS).map(({ name, amplitude, error }) => `${name} ${withError(amplitude, error, "µm")}`).join(", ")}.`
      : `Mesh harmonics 1 to ${count}: ${spoken[0].harmonics}.`;
    this.blocks.harmonics.node.setAttribute("aria-label", tones);
    this.blocks.sharing.node.setAttribute("aria-label", "Load share of each tooth pair over the base pitch.");
  }
}
