/** A scene of one's own: edited in tables, or as TOML, run over time or studied over speed. */

import { ask, get, guarded, patiently } from "./api.js";
import { card } from "./card.js";
import { SETTLED } from "./design.js";
import { button, byId, make } from "./elements.js";
import { faultsOf } from "./job.js";
import { sayMissing } from "./notice.js";
import { MOST, base64, deflated, packedFile, unpackedFile } from "./packed.js";
import { evenly, saveScene, sceneOf } from "./scene.js";
import { changed } from "./schema.js";
import { SceneTable } from "./scene_table.js";
import { Tabs, reveal } from "./tabs.js";
import { OWN, WHOLE } from "./unit.js";

const RUN = { process: "simulate", title: "Run over time", subjects: ["case", "scene"] };
/** By which the text of a scene is known. */
const SCENE = /^\s*\[\[\s*shafts\s*\]\]/m;
/** Lists of parts with a place on a shaft that the picture moves. */
const SLIDING = ["gears", "rolling_bearings", "bushings"];
const RESTED = 150; // milliseconds after which a drag is written
const FIELDS = {
  from: { type: "number", title: "Speeds from, rpm", default: 300 },
  to: { type: "number", title: "to, rpm", default: 3000 },
  count: { type: "number", title: "number", default: 10 },
  microphone_mm: { type: "array", items: { type: "number" }, title: "Microphone x, y, z, mm", default: [0, 0, 1000] },
};

export class SceneEditor {
  /**
   * @param {ReturnType<typeof import("./studies.js").studiesOf>} studies of which those of a scene are offered
   * @param {{slot: Function, show: Function, design: import("./design.js").Design, unit: import("./unit.js").OpenedUnit}} page
   */
  constructor(studies, { slot, show, design, unit }) {
    Object.assign(this, { design, unit, name: "", cases: [] });
    /** @type {any} the scene that is edited, null: none; never changed in place */
    this.scene = null;
    /** Texts with their files by the scene that they were read or written for. @type {WeakMap<object, {toml: string, files: object[]}>} */
    this.texts = new WeakMap();
    /** The text that is the scene. */
    this.written = "";
    /** @type {string | null} word of the address for it, null: that of a job, none, or one that is too long */
    this.word = null;
    /** What the editor holds of the address. */
    this.held = null;
    /** The scene of a job, which is in the address by the job. */
    this.ofJob = null;
    this.text = make("textarea", {
      id: "scene-text", rows: 16, spellcheck: "false", autocomplete: "off", wrap: "off", onchange: () => this.readTyped(),
      oninput: () => {
        clearTimeout(this.typing);
        this.typing = setTimeout(() => this.readTyped(), SETTLED);
      },
    });
    this.tables = make("div", { id: "scene-tables", "data-title": "Table" });
    this.none();
    this.faults = make("div", { role: "status" });
    this.spectrum = make("p", { class: "hint", role: "status" });
    this.chosen = make("p", { class: "hint", role: "status" });
    /** Hash of the run that was shown last, whose sound is heard. */
    this.run = undefined;
    /** Files that the scene names, as they go with its text. */
    this.files = [];
    this.fromPair = button("Write the scene of the pair above", () => {
      this.put(sceneOf(this.known));
      this.look();
    }, { disabled: true });
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
      button("Save scene", () => saveScene({ toml: this.text.value, files: this.files })), button("Show in the picture", () => {
        this.look();
        this.draw();
      }),
    );
    const toml = make("div", { id: "scene-toml", "data-title": "TOML" }, make("label", { for: "scene-text", class: "above" }, "Scene, TOML"), this.text);
    const [tabs, panels] = [make("div", { class: "tabs", role: "tablist", "aria-label": "Scene" }), make("div", {}, this.tables, toml)];
    new Tabs(tabs, panels);
    const compute = make("div", { class: "row" }, make("label", { for: "scene-process" }, "Compute"), this.process);
    return [row, this.chosen, tabs, this.faults, panels, this.spectrum, compute];
  }

  /**
   * Take the scene of a gear unit with its load cases, under which it is deflected.
   * @param {string} name of its file
   * @param {{scene: object, load_cases: object[]}} unit
   */
  async take(name, { scene, load_cases: cases }) {
    await this.put(scene, name, cases, this.unit.mark);
    reveal(this.tables);
    byId("scene-tables-tab").focus();
  }

  /** Begin with another scene. */
  async put(scene, name = "", cases = [], mark = null) {
    this.another(name, cases, mark);
    await this.settle(() => this.edit(scene));
  }

  /** Leave the scene that was here, which undo brings back. @param {string | null} mark of the unit that the next one is of */
  another(name, cases, mark) {
    document.dispatchEvent(new Event("opened"));
    this.mark = mark;
    this.under(name, cases);
  }

  /** Move a gear or bearing of the unit that is open along its shaft: its scene is edited, in place of another. @param {string} part @param {number} position mm */
  slide(part, position) {
    const { name, unit, mark } = this.unit;
    if (this.problem || this.text.value !== this.written) { // to be mended or read first
      reveal(this.text.readOnly ? this.tables : this.text);
      return;
    }
    if (this.mark !== mark || !this.scene) {
      this.another(name, unit.load_cases, mark);
      this.scene = unit.scene;
      document.dispatchEvent(new Event("opened")); // what it was before the edit
    }
    const rows = SLIDING.flatMap((kind) => (this.scene[kind] ?? []).map((row, k) => ({ row, path: [kind, k, "position_mm"] })));
    const moved = rows.find(({ row }) => row.name === part);
    const shown = this.table?.scene === this.scene;
    if (moved) this.scene = changed(this.scene, moved.path, position);
    if (moved && shown) this.table.take(this.scene, moved.path);
    this.unit.take(mark, this.scene);
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.settle(() => (this.table?.scene === this.scene ? this.write() : this.edit(this.scene))), RESTED);
  }

  /** Take the scene as it is edited in a table or was before, and write its text anew. @param {any} scene */
  async edit(scene) {
    if (scene) await this.tabled(scene);
    else this.none();
    return scene ? this.write() : this.carry();
  }

  /** Show a scene in the tables. */
  async tabled(scene) {
    this.scene = scene;
    const { inputs } = this.table ? {} : await patiently(() => get("/v1/processes/simulate"));
    this.table ??= new SceneTable(inputs.scene.schema, (edited) => {
      this.scene = edited;
      this.look();
      this.settle(() => this.write());
    });
    this.table.show(this.scene);
    this.tables.replaceChildren(this.table.block);
    document.dispatchEvent(new Event("opened"));
  }

  async none() {
    this.scene = null;
    this.text.value = this.written = "";
    this.tables.replaceChildren(make("p", { class: "hint" }, NONE));
  }

  async write() {
    const { scene } = this;
    const { toml, files } = this.texts.get(scene) ?? await patiently(() => ask("scene", { inputs: { scene } }));
    this.texts.set(scene, { toml, files });
    if (scene !== this.scene) return;
    this.text.value = this.written = toml;
    this.with(files);
    await this.carry();
  }

  /** Read the scene that is typed as text. */
  async read() {
    const toml = this.text.value;
    const { scene } = await patiently(() => ask("scene-text", { toml, files: this.files }));
    if (toml !== this.text.value) return;
    this.written = toml;
    this.texts.set(scene, { toml, files: this.files });
    await this.tabled(scene);
    await this.carry();
  }

  /** Read what is typed and was not read yet. */
  readTyped() {
    if (this.text.readOnly || (this.text.value === this.written && !this.problem)) return;
    this.look();
    this.settle(() => this.read());
  }

  /** Whether the scene is that of the unit that is open. */
  get ofUnit() {
    return Boolean(this.mark) && this.mark === this.unit.mark;
  }

  /** Let the scene be what the picture shows, or the unit that it is of. */
  look() {
    this.design.view.motions?.leave();
    if (!this.ofUnit) this.design.address.look("see", OWN);
    else if (!this.unit.part) this.unit.look(WHOLE);
  }

  /** Let the picture follow the scene. */
  draw() {
    const { scene, design: { address, view } } = this;
    this.unit.take(this.mark, scene);
    if (address.views.get("see") === OWN) view.see({ scene, open: (mesh) => this.design.goTo(mesh.case, mesh.name) });
  }

  /** Let the address carry the scene with its files and load cases, and the picture show it. */
  async carry() {
    this.draw();
    const { scene, name, written: toml, files, cases, mark } = this;
    const word = scene && scene !== this.ofJob ? await packedFile(name, new TextEncoder().encode(JSON.stringify({ toml, files, cases, mark }))) : null;
    if (scene !== this.scene) return;
    this.long = word?.length > MOST;
    this.word = this.held = this.long ? null : word;
    this.with(files);
    document.dispatchEvent(new Event("typed"));
  }

  /** Show the scene of the address, and the text that a history entry brings back. */
  async follow() {
    const { word } = this;
    await this.settling;
    try {
      if (word && word !== this.held) await this.unpack(word);
    } catch (fault) { // what a damaged address holds
      sayMissing(`The scene: ${fault.message}`);
    }
    if (this.text.value === this.written) this.draw();
    else await this.settle(() => (this.text.value ? this.read() : this.none()));
  }

  /** @param {string} word */
  async unpack(word) {
    const { name, bytes } = await unpackedFile(word);
    const { toml, files, cases, mark } = JSON.parse(new TextDecoder().decode(bytes));
    if (this.text.value === this.written) this.text.value = toml; // else it is as typed last
    this.written = "";
    this.mark = mark;
    this.under(name, cases);
    this.with(files);
  }

  /** What may be undone. */
  get state() {
    const { scene, name, cases, mark } = this;
    return { scene, name, cases, mark };
  }

  /** @param {{scene: any, name: string, cases: any[], mark: string | null}} state */
  async putBack({ scene, name, cases, mark }) {
    if (scene === this.scene) return;
    this.mark = mark;
    this.under(name, cases);
    await this.settle(() => this.edit(scene));
  }

  /** The scene as it is edited. @throws {Problem} it has faults */
  async current() {
    if (this.text.value !== this.written) this.readTyped();
    await this.settling;
    if (this.problem) throw this.problem;
    return this.scene;
  }

  /** Do what changes the scene; what is wrong with it then is said, at its cell where it has one. @param {() => Promise<void>} action */
  settle(action) {
    clearTimeout(this.typing);
    const own = guarded(() => action().then(() => null), (problem) => problem).then((problem) => {
      if (this.settling === own) this.refuse(problem);
    });
    this.settling = own;
    return own;
  }

  /** Say what is wrong with the scene, null: nothing; until it is mended the other view stays as it is. */
  refuse(problem) {
    const ofText = this.text.value !== this.written;
    this.problem = problem;
    if (this.ofUnit) this.unit.say(problem?.errors);
    this.text.readOnly = Boolean(problem) && !ofText;
    this.tables.inert = Boolean(problem) && ofText;
    const marked = this.table?.refuse(ofText ? [] : problem?.errors ?? []);
    const list = ofText || !marked ? problem && faultsOf(problem) : make("ul", {}, ...marked);
    this.faults.replaceChildren(...(problem ? [make("strong", {}, "The scene has faults:"), problem.errors.length ? list : problem.message] : []));
  }

  /** Say under which load cases the scene is deflected; none: under its own loads. */
  under(name, cases) {
    Object.assign(this, { name, cases });
    const leave = button("Leave them out", () => {
      this.under(name, []);
      this.carry();
    });
    const words = `A deflection takes the load cases of ${name}: ${cases.map((load) => load.name).join(", ")}. `;
    this.spectrum.replaceChildren(...(cases.length ? [words, leave] : []));
  }

  /** Say which files go with the text. */
  with(files) {
    this.files = files;
    this.chosen.replaceChildren(
      ...(files.length ? [`With ${files.map(({ name }) => name).join(", ")}.`] : []),
      ...(this.long ? [" The scene is too long for the address: a reload forgets its files."] : []),
    );
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
      this.another("", [], null);
    }
    this.look();
    await this.settle(() => this.read());
  }

  /** Open a scene that was chosen outside this block, and show the block. @param {any} chosen the control that its file was chosen with */
  async open(chosen) {
    await this.opened(chosen);
    reveal(this.tables);
  }

  job({ from, to, count, microphone_mm: microphone }) {
    const process = this.process.value;
    return {
      process,
      inputs: async () => {
        const scene = await this.current();
        if (process === "listen") return { scene, run: this.run, microphone_mm: microphone };
        return { scene, ...this.varied(process, scene, { from, to, count }) };
      },
    };
  }

  /** Take the scene of a job; returns what was typed beside it. */
  typedFor({ processID, inputs }) {
    this.run = inputs.run ?? this.run;
    this.process.value = processID;
    this.ofJob = inputs.scene;
    if (!this.word) this.put(inputs.scene, "this address", inputs.load_cases);
    const speeds = inputs.speed_rpm ?? inputs.heard?.speed_rpm ?? inputs.factors?.[0].levels ?? [];
    const range = { from: speeds[0], to: speeds.at(-1), count: speeds.length || undefined };
    return { ...range, microphone_mm: inputs.microphone_mm };
  }

  /** The mesh whose pair is typed; undefined: none is, so the only one with a case is meant. */
  meshOf({ meshes = [] }) {
    return meshes.find(({ case: own }) => own && !this.design.edits(own).length)?.name;
  }

  /** What a process varies of a scene; a study runs it at each speed of its first drive. */
  varied(process, scene, { from, to, count }, cases = this.cases) {
    const speeds = evenly(from, to, count);
    const loads = cases.length ? { load_cases: cases } : {};
    if (process === "optimize") return { heard: { ...loads, mesh: this.meshOf(scene), speed_rpm: speeds } };
    if (this.whole.has(process)) return {};
    if (process === "deflect") return loads;
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

const NONE = "No scene yet: write that of the pair, open a file or a gear unit, or type it as TOML.";
const HELP = "Shafts, gears, bearings, meshes, drives and loads as in a scene file. A mesh carries its pair written out "
  + "([meshes.case]), names a result of this service (database_hash) or a file: choose the files of cases, flanks "
  + "and housings (STEP, mesh, measured responses as UFF) together with the scene. "
  + "Speeds are those of the first driven shaft. A sound is that of the last run over time that was shown here, through "
  + "the housing of the scene, in the scene's frame.";
