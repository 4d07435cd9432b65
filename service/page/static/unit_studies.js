// @ts-check
/** The studies of an opened unit: a tab each, with its cost before the click; their results at the parts of the unit. */

import { ask, get, guarded, patiently } from "./api.js";
import { card } from "./card.js";
import { estimate } from "./digits.js";
import { byId, dataTable, duration, figures, make } from "./elements.js";

/** @typedef {{name: string, largest_misalignment_um: number, largest_k_h_beta: number | null, mean_peak_to_peak_um: number, largest_in: string}} DeflectedMesh */

const SPEEDS = {
  from: { type: "number", title: "Speeds from, rpm", default: 300 },
  to: { type: "number", title: "to, rpm", default: 3000 },
  count: { type: "number", title: "number", default: 10 },
};
export const OF_UNIT = [ // the name in the address is that of the panel
  { id: "deflection", process: "deflect", title: "Deflection", fields: {} },
  { id: "vibrations", process: "modes", title: "Modes", fields: SPEEDS },
  { id: "response", process: "response", title: "Response", fields: SPEEDS },
  { id: "noise", process: "noise", title: "Noise", fields: SPEEDS },
  { id: "steady", process: "steady", title: "Steady", fields: SPEEDS },
];

/** A number of a mesh under its worst load case. @param {string} what @param {DeflectedMesh} mesh @param {number} value @param {string} unit */
const number = (what, { name, largest_in: load }, value, unit) => (
  estimate({ subject: `${what}; ${name}; ${load}`, value, error: null, unit, rough: true }));

/** @param {DeflectedMesh} mesh */
const ofMesh = (mesh) => [
  number("misalignment", mesh, mesh.largest_misalignment_um, "µm"),
  ...(mesh.largest_k_h_beta === null ? [] : [number("K_Hbeta", mesh, mesh.largest_k_h_beta, "")]),
];

export class UnitStudies {
  /**
   * @param {ReturnType<typeof import("./studies.js").studiesOf>} studies of the service
   * @param {{slot: Function, show: Function, design: import("./design.js").Design, unit: import("./unit.js").OpenedUnit}} page
   * @param {import("./scene_editor.js").SceneEditor} scenes whose scene is computed where it is that of the unit
   */
  constructor(studies, page, scenes) {
    Object.assign(this, { page, scenes, unit: page.unit });
    /** @type {any} the scene whose cost is known */
    this.planned = null;
    this.costs = [];
    for (const { id, process, title, fields } of OF_UNIT) {
      const study = studies.find((known) => known.process === process);
      const cost = make("p", { class: "hint", role: "status" });
      const panel = make("div", { id, "data-title": title, "data-of": "unit" });
      this.costs.push(cost);
      byId("panels").insertBefore(panel, byId("sound"));
      const shown = { slot: page.slot, show: (...result) => this.show(process, ...result) };
      panel.append(card({ ...study, title, process: id, fields }, shown, (values) => ({ process, inputs: () => this.inputs(process, values) }),
        { typed: ({ inputs: { speed_rpm: speeds = [] } }) => ({ from: speeds[0], to: speeds.at(-1), count: speeds.length || undefined }), more: [cost] }));
    }
    this.unit.seen = () => this.follow();
    page.design.watch(() => this.entitle());
  }

  /** The scene of the unit, as it is edited, and what a process takes beside it. @param {string} process @param {any} values */
  async inputs(process, values) {
    const { scenes, unit } = this;
    const scene = scenes.ofUnit && scenes.scene ? await scenes.current() : unit.unit.scene;
    const cases = scenes.ofUnit ? scenes.cases : unit.unit.load_cases;
    return { scene, ...scenes.varied(process, scene, values, cases) };
  }

  /** Another subject is seen: the pair, or the unit with its tabs and its part of the dock. */
  follow() {
    const { unit } = this;
    const seen = unit.isSeen;
    document.body.dataset.seen = seen ? "unit" : "pair";
    byId("unit-dock").hidden = !seen;
    document.dispatchEvent(new Event("subject"));
    if (!seen) return;
    if (this.deflected?.mark !== unit.mark) this.deflected = null;
    byId("unit-title").textContent = unit.name;
    figures(byId("unit-figures"), unit.meshes.map((mesh) => {
      const found = this.deflected?.meshes.find(({ name }) => name === mesh.name);
      const parts = found ? ofMesh(found) : [];
      return [mesh.name, "", found ? [{ ...parts[0], text: `misaligned by ${parts[0].text}` }, parts[1] && { ...parts[1], text: `K_Hbeta ${parts[1].text}` }, found.largest_in] : ["not deflected yet"]];
    }));
    this.entitle();
    this.plan();
  }

  /** Say of which mesh the pair below is. */
  entitle() {
    const mesh = this.unit.isSeen && this.unit.openedMesh;
    byId("unit-pair").textContent = mesh ? `The pair of ${mesh.name}` : "";
  }

  /** Say what the tables of its meshes take, before anything is computed. */
  async plan() {
    const { scene } = this.unit.unit;
    if (scene === this.planned) return;
    this.planned = scene;
    const cases = (scene.meshes ?? []).filter((mesh) => mesh.case);
    const say = (text) => this.costs.forEach((cost) => { cost.textContent = text; });
    say("Time and memory are being predicted.");
    await guarded(async () => {
      const plans = [];
      for (const mesh of cases) plans.push(await patiently(() => ask("plan", { inputs: { case: mesh.case }, caller: "unit-plan" })));
      if (scene !== this.planned) return;
      const passes = plans.flatMap((plan) => plan.passes);
      const seconds = passes.reduce((sum, { cost }) => sum + cost.cpu_seconds, 0);
      const memory = Math.max(0, ...passes.map(({ cost }) => cost.memory_bytes));
      say(`Takes about ${duration(seconds)} of one processor and ${Math.round(memory / 2 ** 20)} MiB for the tables of ${cases.length} meshes, less where they are stored; then a few seconds.`);
    }, (problem) => say(`No plan: ${problem.message}`));
  }

  /** Show what came of a study; of a deflection the numbers at their meshes, the unit bent. */
  async show(process, target, reference, signal, inputs) {
    if (process === "deflect") await this.deflection(target, reference, signal);
    await this.page.show(target, reference, signal, inputs);
    if (process === "deflect" && !signal.aborted) target.prepend(this.table);
  }

  async deflection(target, { href }, signal) {
    const { meshes, load_cases: loads } = await patiently(() => get(href));
    if (signal.aborted) return;
    this.deflected = { mark: this.unit.mark, meshes };
    const rows = meshes.map((mesh) => [mesh.name, ...ofMesh(mesh), mesh.largest_in]);
    this.table = dataTable({ caption: "Meshes under their worst load case", head: ["mesh", "misaligned by", "K_Hbeta", "load case"], rows });
    this.unit.note(new Map(meshes.map((mesh) => [mesh.name, ofMesh(mesh)])));
    const worst = [...meshes].sort((one, other) => Math.abs(other.largest_misalignment_um) - Math.abs(one.largest_misalignment_um))[0];
    this.page.design.view.motion ??= String(Math.max(0, loads.findIndex(({ name }) => name === worst.largest_in)));
    this.follow();
  }
}
