/** A scene of one's own: opened or written as TOML, run over time or studied over speed. */

import { Problem, post } from "./api.js";
import { card } from "./card.js";
import { evenly, usualScene } from "./dynamics.js";
import { byId, make, save } from "./elements.js";
import { showFailure } from "./job.js";

const WHAT = [
  ["simulate", "Run over time"], ["modes", "Modes over speed"], ["response", "Forced response over speed"],
  ["steady", "Steady states over speed"], ["deflect", "Deflection under its loads"],
  ["study", "Many runs, at constant speeds"],
];
const FIELDS = [
  { name: "process", label: "Compute", choices: WHAT },
  { name: "from", label: "Speeds from, rpm", value: "300" },
  { name: "to", label: "to, rpm", value: "3000" },
  { name: "count", label: "number", value: "10" },
];

export class SceneEditor {
  /** @param {{slot: Function, show: Function}} page */
  constructor({ slot, show }) {
    this.text = make("textarea", {
      id: "scene-text", rows: 16, spellcheck: "false", autocomplete: "off", wrap: "off",
    });
    this.refusal = make("div");
    this.fromPair = make("button", { type: "button", disabled: true, onclick: () => this.write() }, "Write the scene of the pair above");
    byId("scene-body").replaceChildren(card(
      { title: "A scene of your own", action: "Compute the scene", text: HELP, fields: FIELDS, more: this.parts() },
      (parts) => slot("scene", parts, show),
      (values) => this.job(values),
    ));
  }

  /** @param {object | null} known the analyzed pair, which a scene may be written for */
  show(known) {
    this.known = known;
    this.fromPair.disabled = known === null || known.case.pair.wheel.internal;
  }

  parts() {
    const chosen = make("input", {
      class: "hidden-file", id: "scene-file", type: "file", accept: ".toml", "aria-label": "Open a scene file, TOML",
      onchange: () => this.opened(chosen),
    });
    const row = make(
      "div", { class: "buttons" },
      chosen, make("label", { class: "button", for: "scene-file" }, "Open scene file…"), this.fromPair,
      make("button", { type: "button", onclick: () => save(this.text.value, "scene.toml", "application/toml") }, "Save scene"),
    );
    return [row, make("label", { for: "scene-text", class: "above" }, "Scene, TOML"), this.text, this.refusal];
  }

  async opened(chosen) {
    const [given] = chosen.files;
    if (!given) return;
    this.text.value = await given.text();
    chosen.value = "";
    document.dispatchEvent(new Event("typed"));
    await this.careful(() => this.read());
  }

  async write() {
    await this.careful(async () => {
      this.text.value = (await post("/v1/scenes/to-toml", { inputs: { scene: usualScene(this.known) } })).toml;
      document.dispatchEvent(new Event("typed"));
    });
  }

  async read() {
    return (await post("/v1/scenes/from-toml", { toml: this.text.value })).scene;
  }

  /** Do something that the service may refuse; say so under the text. */
  async careful(action) {
    this.refusal.replaceChildren();
    try {
      await action();
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      showFailure(this.refusal, problem);
    }
  }

  job({ process, from, to, count }) {
    this.refusal.replaceChildren();
    return {
      process,
      inputs: async () => {
        const scene = await this.read();
        return { scene, ...varied(process, scene, evenly(from, to, count)) };
      },
    };
  }
}

/** What a process varies of a scene; a study runs it at each speed of its first drive. */
function varied(process, scene, speeds) {
  if (process === "simulate" || process === "deflect") return {};
  if (process !== "study") return { speed_rpm: speeds };
  const path = `drives.${(scene.drives ?? [{ name: "?" }])[0].name}.speed_rpm`;
  return { factors: [{ path, levels: speeds }], responses: RESPONSES };
}

const RESPONSES = [
  { quantity: "dte_peak_to_peak" }, { quantity: "bearing_force", order: 1 }, { quantity: "dynamic_factor" },
  { quantity: "contact_loss" },
];

const HELP = "Shafts, gears, bearings, meshes, drives and loads as in a scene file. A mesh carries its pair written out "
  + "([meshes.case]) or names a result of this service (database_hash); files that it names are not read here. "
  + "Speeds are those of the first driven shaft.";
