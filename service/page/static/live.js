/** Sliders that redraw the transmission error from the compliance the service keeps. */

import { Problem, pause, post } from "./api.js";
import { byId, figures, make, number } from "./elements.js";
import { figureBlock, plot } from "./plots.js";

const FONT = { family: "system-ui, -apple-system, 'Segoe UI', 'Liberation Sans', sans-serif", size: 13 };
const [BEFORE, NOW] = ["#767676", "#0072B2"];
const PAIRS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"];
const SHOWN_HARMONICS = 8;
const RELIEF_LENGTH = 0.5; // normal modules, where the case has no relief to take it from
const ACROSS = ["helix_crowning_um", "misalignment_um"];

const rounded = (value, step) => Math.round(value / step) * step;

/** What the sliders change: name of the value, label, unit, range by case. */
function knobs(known) {
  const relief = Math.max(20, rounded(12 * known.case.pair.normal_module_mm, 5));
  const gear = (name) => known.case.pair[name];
  return [
    { key: "torque_n_m", label: "Torque on the pinion", unit: "N m", low: 0, high: 2 * known.highest, value: known.torque },
    { key: "pinion.tip_relief_um", label: "Tip relief, pinion", unit: "µm", low: 0, high: relief, value: gear("pinion").tip_relief_um },
    { key: "wheel.tip_relief_um", label: "Tip relief, wheel", unit: "µm", low: 0, high: relief, value: gear("wheel").tip_relief_um },
    { key: "pinion.helix_crowning_um", label: "Crowning, pinion", unit: "µm", low: 0, high: 30, value: gear("pinion").helix_crowning_um },
    { key: "misalignment_um", label: "Misalignment", unit: "µm", low: -50, high: 50, value: 0 },
  ];
}

export class Live {
  constructor(actions) {
    this.actions = actions;
    this.caller = `page-${Math.random().toString(36).slice(2, 12)}`;
    this.waiting = null;
    this.busy = false;
  }

  /**
   * Begin with the result of an analysis.
   * @param {{key: string, case: object, torques: number[], plane: boolean}} known
   */
  async show(known) {
    const highest = known.torques.at(-1);
    const middle = known.torques[Math.floor(known.torques.length / 2)];
    this.known = { ...known, highest, torque: middle };
    this.before = null;
    byId("live-none").hidden = true;
    byId("live-body").hidden = false;
    this.sliders();
    this.plots();
    await this.ask();
  }

  sliders() {
    this.controls = knobs(this.known).map((knob) => this.slider(knob));
    const { plane } = this.known;
    const note = plane ? make(
      "div", {},
      make("p", { class: "hint" }, "Computed in the plane: crowning and misalignment act across the face and need three dimensions."),
      make("button", { type: "button", onclick: () => this.actions.inThreeDimensions() }, "Analyse in three dimensions"),
    ) : null;
    byId("sliders").replaceChildren(
      ...this.controls.map(({ block }) => block), note ?? "",
      make(
        "div", { class: "buttons" },
        make("button", { type: "button", onclick: () => this.reset() }, "As analysed"),
        make("button", { type: "button", onclick: () => this.actions.take(this.flanks()) }, "Take these flanks into the case"),
      ),
      make("p", { class: "hint", id: "live-time" }, ""),
    );
  }

  slider(knob) {
    const id = `live-${knob.key.replace(".", "-")}`;
    const step = knob.high > 500 ? 5 : knob.high > 100 ? 1 : knob.high > 20 ? 0.5 : knob.high / 100;
    const low = knob.key === "torque_n_m" ? step : knob.low;
    const disabled = this.known.plane && ACROSS.some((name) => knob.key.endsWith(name));
    const facts = { min: low, max: knob.high, step, disabled };
    const range = make("input", { ...facts, type: "range", id });
    const exact = make("input", { ...facts, type: "number", "aria-label": `${knob.label}, ${knob.unit}, as a number` });
    for (const input of [range, exact]) input.value = knob.value;
    const changed = (from, to) => () => {
      to.value = from.value;
      range.setAttribute("aria-valuetext", `${from.value} ${knob.unit}`);
      this.ask();
    };
    range.addEventListener("input", changed(range, exact));
    exact.addEventListener("input", changed(exact, range));
    const label = make("label", { for: id }, `${knob.label}, ${knob.unit}`);
    return { knob, range, exact, block: make("div", { class: "slider" }, label, range, exact) };
  }

  reset() {
    for (const { knob, range, exact } of this.controls) {
      range.value = knob.value;
      exact.value = knob.value;
    }
    this.ask();
  }

  value(key) {
    const found = this.controls.find(({ knob }) => knob.key === key);
    return Number(found.exact.value);
  }

  flanks() {
    const changes = { pinion: {}, wheel: {} };
    for (const { knob, exact } of this.controls) {
      const [gear, name] = knob.key.split(".");
      if (!name || Number(exact.value) === knob.value) continue;
      changes[gear][name] = Number(exact.value);
      const length = this.known.case.pair[gear].tip_relief_length_mm;
      if (name === "tip_relief_um" && !length) {
        changes[gear].tip_relief_length_mm = RELIEF_LENGTH * this.known.case.pair.normal_module_mm;
      }
    }
    return changes;
  }

  /** Ask for where the sliders are now; while an answer is on its way only the newest wish is kept. */
  async ask() {
    const torque = [this.value("torque_n_m")];
    this.waiting = { torque_n_m: torque, misalignment_um: this.value("misalignment_um"), ...this.flanks() };
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.waiting) await this.next();
    } finally {
      this.busy = false;
    }
  }

  async next() {
    const { waiting } = this;
    this.waiting = null;
    const key = this.known.key;
    try {
      const begin = performance.now();
      await this.baseline(waiting.torque_n_m, key);
      const found = await post(`/v1/databases/${key}/ste`, { ...waiting, caller: this.caller });
      const round = performance.now() - begin;
      if (key !== this.known.key) return;
      await this.draw(found.curves[0]);
      this.timed(round, performance.now() - begin, found);
      byId("live-errors").hidden = true;
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      if (problem.type.endsWith("superseded")) return;
      this.refuse(problem);
      if (!problem.retryAfter) return;
      await pause(1000 * problem.retryAfter); // the service is busy: ask again, for what is wanted by then
      this.waiting ??= waiting;
    }
  }

  /** The curve as analysed at this torque, to compare with. */
  async baseline(torque, key) {
    if (this.before?.torque_n_m === torque[0] && this.before?.key === key) return;
    const found = await post(`/v1/databases/${key}/ste`, { torque_n_m: torque, caller: `${this.caller}-before` });
    this.before = { ...found.curves[0], key };
  }

  refuse(problem) {
    const box = byId("live-errors");
    const lines = problem.errors.map((fault) => make("li", {}, `${fault.field} must be ${fault.bound}. ${fault.suggestion || ""}`));
    box.replaceChildren(lines.length ? make("ul", {}, ...lines) : make("p", {}, problem.message));
    box.hidden = false;
  }

  timed(round, all, found) {
    byId("live-time").textContent = `Answered in ${round.toFixed(0)} ms, drawn after ${all.toFixed(0)} ms.`;
    Object.assign(byId("live-body").dataset, { answered: round.toFixed(1), milliseconds: all.toFixed(1), cpu: found.cpu_seconds });
    byId("live-body").dataset.answers = Number(byId("live-body").dataset.answers || 0) + 1;
    if (found.beyond_load_patches) {
      byId("live-time").textContent += ` At ${found.beyond_load_patches} points the contact is wider than the mesh allows for.`;
    }
  }

  plots() {
    const make3 = (key, title, caption) => figureBlock({ key, title, caption, alternative: "", plot: { data: [], layout: {} } }, "h3");
    this.blocks = {
      ste: make3("live_ste", "Transmission error over two base pitches", "Grey: as analysed, at the same torque and aligned."),
      harmonics: make3("live_harmonics", "Mesh harmonics", "Amplitudes of the mesh frequency and its multiples."),
      sharing: make3("live_load_share", "Load sharing", "Part of the load on each pair of teeth."),
    };
    for (const { block } of Object.values(this.blocks)) block.querySelector(".plot-tools").remove();
    const pair = make("div", { class: "live-pair" }, this.blocks.ste.block, this.blocks.harmonics.block);
    byId("live-plots").replaceChildren(pair, this.blocks.sharing.block);
  }

  async draw(now) {
    const { before } = this;
    const change = (value, from) => (from === 0 ? "" : `${value >= from ? "+" : "−"}${number(Math.abs(100 * (value / from - 1)), 3)} %`);
    figures(byId("live-figures"), [
      ["peak to peak", `${number(now.peak_to_peak_um, 3)} µm`, change(now.peak_to_peak_um, before.peak_to_peak_um)],
      ["mean", `${number(now.mean_um, 4)} µm`, change(now.mean_um, before.mean_um)],
      ["first harmonic", `${number(now.harmonics_um[0], 3)} µm`, change(now.harmonics_um[0], before.harmonics_um[0])],
    ]);
    await Promise.all([
      plot(this.blocks.ste.node, steFigure(before, now)),
      plot(this.blocks.harmonics.node, harmonicsFigure(before, now)),
      plot(this.blocks.sharing.node, sharingFigure(now)),
    ]);
    this.describe(now, before);
  }

  describe(now, before) {
    const words = `Transmission error: peak to peak ${number(now.peak_to_peak_um, 3)} µm, as analysed ${number(before.peak_to_peak_um, 3)} µm; `
      + `mean ${number(now.mean_um, 4)} µm.`;
    this.blocks.ste.node.setAttribute("aria-label", words);
    const tones = now.harmonics_um.slice(0, SHOWN_HARMONICS).map((value) => number(value, 3)).join(", ");
    this.blocks.harmonics.node.setAttribute("aria-label", `Mesh harmonics 1 to ${SHOWN_HARMONICS}: ${tones} µm.`);
    this.blocks.sharing.node.setAttribute("aria-label", "Load share of each tooth pair over the base pitch.");
  }
}

/** Positions and values over two pitches (or the whole longer period), closed. */
function over(curve, values) {
  const turns = curve.period === 1 ? [0, 1] : [0];
  const x = turns.flatMap((turn) => curve.position.map((place) => place + turn * curve.period));
  const y = turns.flatMap(() => values);
  return { x: [...x, curve.position[0] + turns.length * curve.period], y: [...y, values[0]] };
}

function layout(height, x, y, more = {}) {
  const axis = (text) => ({
    title: { text, standoff: 8, font: { size: 13 } }, gridcolor: "#DDE1E6", linecolor: "#59636E", zeroline: false, ticks: "outside",
    tickcolor: "#59636E", automargin: true,
  });
  return {
    height, font: { ...FONT, color: "#1B1F24" }, margin: { l: 60, r: 12, t: 34, b: 48 }, xaxis: axis(x), yaxis: axis(y),
    legend: { orientation: "h", x: 0, y: 1, yref: "container", yanchor: "top" }, hovermode: "x unified", ...more,
  };
}

function steFigure(before, now) {
  const line = (curve, name, color, width, dash) => ({
    ...over(curve, curve.ste_um), type: "scatter", mode: "lines", name, line: { color, width, dash },
  });
  const data = [line(before, "as analysed", BEFORE, 1.8, "dash"), line(now, "now", NOW, 2.4, "solid")];
  return { data, layout: layout(360, "position, base pitches", "transmission error, µm") };
}

function harmonicsFigure(before, now) {
  const order = Array.from({ length: SHOWN_HARMONICS }, (_, k) => k + 1);
  const bars = (curve, name, color) => ({
    type: "bar", name, x: order, y: curve.harmonics_um.slice(0, SHOWN_HARMONICS), marker: { color },
  });
  const data = [bars(before, "as analysed", BEFORE), bars(now, "now", NOW)];
  const made = layout(360, "harmonic of the mesh", "amplitude, µm", { bargap: 0.25 });
  made.xaxis.dtick = 1;
  return { data, layout: made };
}

/** The share of one pair of teeth as it moves on: with every base pitch it is one pair further ahead. */
function shareOf(curve, pair) {
  const column = (turn) => curve.pair.indexOf(pair + turn);
  const at = (row, turn) => (column(turn) < 0 ? 0 : row[column(turn)]);
  const turns = [0, 1];
  const x = turns.flatMap((turn) => curve.position.map((place) => place + turn));
  const y = turns.flatMap((turn) => curve.load_share.map((row) => at(row, turn)));
  return { x: [...x, 2], y: [...y, at(curve.load_share[0], 2)] };
}

function sharingFigure(now) {
  const wanted = now.period === 1 ? [now.pair[0] - 1, ...now.pair] : now.pair;
  const lines = wanted.map((pair) => [pair, now.period === 1
    ? shareOf(now, pair) : over(now, now.load_share.map((row) => row[now.pair.indexOf(pair)]))]);
  const data = lines.filter(([, line]) => Math.max(...line.y) > 1e-6).map(([pair, line], k) => ({
    ...line, y: line.y.map((share) => (share > 1e-9 ? share : null)), type: "scatter", mode: "lines", name: `pair ${pair > 0 ? "+" : ""}${pair}`,
    line: { color: PAIRS[k % PAIRS.length], width: 2 },
  }));
  const made = layout(280, "position, base pitches", "load share");
  made.yaxis.range = [-0.02, 1.05];
  return { data, layout: made };
}
