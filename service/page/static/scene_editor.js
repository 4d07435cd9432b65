/** A scene of one's own: opened or written as TOML, run over time or studied over speed. */

import { guarded, post } from "./api.js";
import { card } from "./card.js";
import { button, byId, make } from "./elements.js";
import { showFailure } from "./job.js";
import { base64, deflated } from "./packed.js";
import { evenly, saveScene, sceneOf } from "./scene.js";
import { reveal } from "./tabs.js";

const RUN = { process: "simulate", title: "Run over time", subjects: ["case", "scene"] };
/** By which the text of a scene is known. */
const SCENE = /^\s*\[\[\s*shafts\s*\]\]/m;
const FIELDS = {
  from: { type: "number", title: "Speeds from, rpm", default: 300 },
  to: { type: "number", title: "to, rpm", default: 3000 },
  count: { type: "number", title: "number", default: 10 },
  microphone_mm: { type: "array", items: { type: "number" }, title: "Microphone x, y, z, mm", default: [0, 0, 1000] },
};

export class SceneEditor {
  /**
   * @param {ReturnType<typeof import("./studies.js").studiesOf>} studies of which those of a scene are offered
   * @param {{slot: Function, show: Function, design: import("./design.js").Design}} page
   */
  constructor(studies, { slot, show, design }) {
    this.design = design;
    this.text = make("textarea", {
      id: "scene-text", rows: 16, spellcheck: "false", autocomplete: "off", wrap: "off",
    });
    this.refusal = make("div");
    this.spectrum = make("p", { class: "hint", role: "status" });
    this.chosen = make("p", { class: "hint", role: "status" });
    this.cases = [];
    /** Hash of the run that was shown last, whose sound is heard. */
    this.run = undefined;
    /** Files that the scene names, as they go with its text. */
    this.files = [];
    this.fromPair = button("Write the scene of the pair above", () => this.put(sceneOf(this.known)), { disabled: true });
    const ofScenes = [RUN, ...studies.filter(({ subjects }) => subjects.includes("scene"))];
    /** Of which a scene is all they take. */
    this.whole = new Set(ofScenes.filter(({ subjects }) => subjects.includes("case")).map(({ process }) => process));
    this.process = make("select", { id: "scene-process" }, ...ofScenes.map(({ process, title }) => make("option", { value: process }, title)));
    const shown = (target, reference, signal, inputs) => {
      if (reference.kind === "run") this.run = reference.hash;
      return show(target, reference, signal, inputs);
    };
    byId("scene-body").replaceChildren(card(
      { process: "scene", title: "A scene of your own", action: "Compute the scene", text: HELP, fields: FIELDS }, { slot, show: shown },
      (values) => this.job(values), { typed: (order) => this.typedFor(order), more: this.parts() },
    ));
  }

  /** @param {object | null} known the analyzed pair, which a scene may be written for */
  show(known) {
    this.known = known;
    this.fromPair.disabled = known === null || known.case.pair.wheel.internal;
  }

  parts() {
    const chosen = make("input", {
      class: "hidden-file", id: "scene-file", type: "file", multiple: true,
      "aria-label": "Open a scene file, TOML, and the files that it names",
      onchange: () => this.opened(chosen),
    });
    const row = make(
      "div", { class: "buttons" },
      chosen, make("label", { class: "button", for: "scene-file" }, "Open scene file…"), this.fromPair,
      button("Save scene", () => saveScene({ toml: this.text.value, files: this.files })),
    );
    const label = make("label", { for: "scene-text", class: "above" }, "Scene, TOML");
    const compute = make("div", { class: "row" }, make("label", { for: "scene-process" }, "Compute"), this.process);
    return [row, this.chosen, label, this.text, this.spectrum, this.refusal, compute];
  }

  /**
   * Take the scene of a gear unit with its load cases, under which it is deflected.
   * @param {string} name of its file
   * @param {{scene: object, load_cases: object[]}} unit
   */
  async take(name, { scene, load_cases: cases }) {
    await this.put(scene, name, cases);
    reveal(this.text);
    this.text.focus();
  }

  /** Put a scene into the text. */
  async put(scene, name = "", cases = []) {
    await this.careful(async () => {
      const { toml, files } = await post("/v1/scenes/to-files", { inputs: { scene } });
      this.text.value = toml;
      this.with(files);
      this.under(name, cases);
      document.dispatchEvent(new Event("typed"));
    });
  }

  /** Say under which load cases the scene is deflected; none: under its own loads. */
  under(name, cases) {
    this.cases = cases;
    const leave = button("Leave them out", () => this.under("", []));
    const words = `A deflection takes the load cases of ${name}: ${cases.map((load) => load.name).join(", ")}. `;
    this.spectrum.replaceChildren(...(cases.length ? [words, leave] : []));
  }

  /** Say which files go with the text. */
  with(files) {
    this.files = files;
    this.chosen.replaceChildren(...(files.length ? [`With ${files.map(({ name }) => name).join(", ")}.`] : []));
  }

  /** Open a scene with the files that it names; files without one belong to the scene that is here. */
  async opened(chosen) {
    if (!chosen.files.length) return;
    const { text, name, files } = await textAndFiles(chosen.files);
    chosen.value = "";
    const others = this.files.filter((known) => !files.some((file) => file.name === known.name));
    this.with(name ? files : [...others, ...files]);
    if (name) {
      this.text.value = text;
      this.under("", []);
    }
    document.dispatchEvent(new Event("typed"));
    await this.careful(() => this.read());
  }

  async read() {
    return (await post("/v1/scenes/from-toml", { toml: this.text.value, files: this.files })).scene;
  }

  /** Do something that the service may refuse; say so under the text. */
  careful(action) {
    this.refusal.replaceChildren();
    return guarded(action, (problem) => showFailure(this.refusal, problem));
  }

  job({ from, to, count, microphone_mm: microphone }) {
    this.refusal.replaceChildren();
    const process = this.process.value;
    return {
      process,
      inputs: async () => {
        const scene = await this.read();
        if (process === "listen") return { scene, run: this.run, microphone_mm: microphone };
        return { scene, ...this.varied(process, scene, evenly(from, to, count)) };
      },
    };
  }

  /** Take the scene of a job; returns what was typed beside it. */
  typedFor({ processID, inputs }) {
    this.run = inputs.run ?? this.run;
    this.process.value = processID;
    this.put(inputs.scene, "this address", inputs.load_cases);
    const speeds = inputs.speed_rpm ?? inputs.factors?.[0].levels ?? [];
    const range = { from: speeds[0], to: speeds.at(-1), count: speeds.length || undefined };
    return { ...range, microphone_mm: inputs.microphone_mm };
  }

  /** What a process varies of a scene; a study runs it at each speed of its first drive. */
  varied(process, scene, speeds) {
    if (this.whole.has(process)) return {};
    if (process === "deflect") return this.cases.length ? { load_cases: this.cases } : {};
    if (process === "change") return { after: this.design.case, speed_rpm: speeds };
    if (process !== "study") return { speed_rpm: speeds };
    const path = `drives.${(scene.drives ?? [{ name: "?" }])[0].name}.speed_rpm`;
    return { factors: [{ path, levels: speeds }], responses: RESPONSES };
  }
}

/** The TOML file that is a scene by its text, or else the first, and what is chosen with it; no name: none is TOML. @param {Iterable<File>} chosen */
async function textAndFiles(chosen) {
  const all = [...chosen];
  const texts = await Promise.all(all.filter(({ name }) => name.endsWith(".toml")).map(async (file) => ({ file, text: await file.text() })));
  const main = texts.find(({ text }) => SCENE.test(text)) ?? texts[0];
  const files = await Promise.all(all.filter((file) => file !== main?.file).map(packed));
  return { text: main?.text ?? "", name: main?.file.name ?? "", files };
}

/** The file compressed by zlib, in Base64, as a request carries it. @param {File} file */
const packed = async (file) => ({ name: file.name, content: base64(await deflated(new Uint8Array(await file.arrayBuffer()))) });

const RESPONSES = [
  { quantity: "dte_peak_to_peak" }, { quantity: "bearing_force", order: 1 }, { quantity: "dynamic_factor" },
  { quantity: "contact_loss" },
];

const HELP = "Shafts, gears, bearings, meshes, drives and loads as in a scene file. A mesh carries its pair written out "
  + "([meshes.case]), names a result of this service (database_hash) or a file: choose the files of cases, flanks "
  + "and housings (STEP, mesh) together with the scene. "
  + "Speeds are those of the first driven shaft. A sound is that of the last run over time that was shown here, through "
  + "the housing of the scene, in the scene's frame.";
