// @ts-check
/** A gear unit of another tool (REXS): its tree in the rail, each mesh opened into the form, and the account. */

import { Problem, patiently, post } from "./api.js";
import { button, byId, folded, make, number, save } from "./elements.js";
import { sayMissing } from "./notice.js";
import { MOST, base64, packedFile, unpackedFile } from "./packed.js";
import { saveScene } from "./scene.js";
import { same } from "./schema.js";
import { translated } from "./unit_heard.js";
import { isSolid } from "./view_housing.js";

const FATES = ["taken", "assumed", "derived", "defaulted", "ignored", "refused"];
const ENDINGS = /\.(rexs|rexsj|rexsz|zip)$/i;
const MARK = 8; // characters at the end of its word, a checksum
export const WHOLE = "unit"; // what is seen of a unit that is opened
export const OWN = "scene"; // what is seen where the scene that is edited is that of no such unit

/** @param {string} name of a file */
export const isUnit = (name) => ENDINGS.test(name);

export class OpenedUnit {
  /**
   * @param {import("./design.js").Design} design
   * @param {object} page
   * @param {(name: string, unit: object) => Promise<void>} page.scene opens the scene
   * @param {(part: string, position: number) => void} page.slide moves a part along its shaft, mm
   * @param {(views: Record<string, string | null>) => Promise<void>} page.go goes on to an entry of the history that shows the unit
   */
  constructor(design, page) {
    Object.assign(this, { design, page });
    /** @type {string | null} the word of the unit that is shown */
    this.word = null;
    this.unit = null;
    this.place = byId("unit");
    this.seen = () => {}; // called when the unit or its pair is seen
  }

  /** @param {File} file */
  async open(file) {
    this.word = null;
    this.place.replaceChildren(); // the buttons of an earlier unit would open that one
    const { complaint: before = {} } = this.design.case;
    const bytes = new Uint8Array(await file.arrayBuffer());
    const unit = await post("/v1/units/open", { rexs_base64: base64(bytes) });
    this.put(await packedFile(file.name, bytes), file.name, unit);
    if (this.word.length > MOST) this.place.append(make("p", { class: "hint" }, "The file is too long for the address: a reload forgets it."));
    const { complaint: typed = {} } = this.design.case; // meanwhile
    await this.page.go({ unit: this.word.length > MOST ? null : this.word, see: WHOLE, name: file.name.replace(/\.\w+$/, "") });
    if (!same(before, typed)) this.design.take(Object.fromEntries(Object.entries(typed).map(([field, value]) => [`complaint.${field}`, value])));
  }

  /** Show the unit of an address, or none. @param {string | undefined} word @returns {Promise<any>} the pair of its first mesh */
  async follow(word) {
    try {
      if (word && word !== this.word) {
        const { name, bytes } = await unpackedFile(word);
        this.place.hidden = false;
        this.place.replaceChildren(make("p", { class: "hint", role: "status" }, `${name} is being read.`));
        this.put(word, name, await patiently(() => post("/v1/units/open", { rexs_base64: base64(bytes) })));
      }
    } catch (problem) {
      if (problem instanceof Problem || problem instanceof TypeError) sayMissing(`The gear unit: ${problem.message}`);
      else throw problem;
    }
    this.place.hidden = !word || word !== this.word;
    return this.place.hidden ? null : this.meshes[0]?.case ?? null;
  }

  /** The meshes of its scene, or else its stages: each with a name and a case. */
  get meshes() {
    const { scene, cases } = this.unit;
    return scene ? (scene.meshes ?? []).filter((mesh) => mesh.case) : cases;
  }

  /** Whether the unit is what the page is about: not a pair of it. */
  get isSeen() {
    return Boolean(this.part) && !this.place.hidden && Boolean(this.unit?.scene);
  }

  /** The mesh whose pair is typed, else the first. */
  get openedMesh() {
    const { pair } = this.design.case;
    const alike = ({ case: { pair: own } }) => own.center_distance_mm === pair?.center_distance_mm && ["pinion", "wheel"].every((gear) => own[gear].teeth === pair?.[gear]?.teeth);
    return this.meshes.find(alike) ?? this.meshes[0];
  }

  /** Let results stand at their meshes in the tree. @param {Map<string, import("./digits.js").Printed[]>} notes */
  note(notes) {
    for (const node of this.place.querySelectorAll("[data-mesh]")) {
      const parts = notes.get(node.dataset.mesh) ?? [];
      node.replaceChildren(...parts.flatMap(({ text, data }, k) => [k ? ", K_Hbeta " : " ", make("span", data, text)]));
    }
  }

  /** By which its scene is known; null: none is shown. */
  get mark() {
    return this.place.hidden || !this.unit?.scene ? null : this.word.slice(-MARK);
  }

  /** Show the scene of a unit as it is edited. @param {string | null} mark of the unit @param {any} scene */
  take(mark, scene) {
    if (!mark || mark !== this.mark || !scene || scene === this.unit.scene) return;
    const before = this.unit.scene;
    this.unit.scene = scene;
    this.place.querySelector(".parts").replaceWith(this.tree());
    this.say();
    this.design.view.replace(before, scene);
  }

  /** Mark what is seen, in the tree and in three dimensions; nothing: the pair is seen. @param {string | undefined} part */
  see(part) {
    this.part = part === OWN ? undefined : part;
    this.say();
    this.seen();
    if (part === OWN) return; // the editor shows it
    const scene = part && !this.place.hidden ? this.unit.scene : null;
    this.design.view.motions?.leave();
    this.design.view.see({ scene, part, open: (mesh) => this.openMesh(mesh), slid: this.page.slide });
  }

  /** Say in the tree and below it what is seen. @param {{field: string, bound: string}[]} [faults] of its scene */
  say(faults = []) {
    const { part } = this;
    for (const button of this.place.querySelectorAll("[data-part]")) button.setAttribute("aria-pressed", String(button.dataset.part === part));
    const fact = this.place.querySelector("[role=status]");
    const wrong = faults.map(({ field, bound }) => `${field} must be ${bound}.`);
    if (fact) fact.textContent = [this.facts?.get(part) ?? this.summary, ...wrong].join(" ");
  }

  /** @param {string} part */
  look(part) {
    this.design.address.look("see", part);
    this.see(part);
  }

  /** Open the pair of a mesh, with what is complained of at its speed and torque. */
  openMesh(mesh) {
    const complaint = translated(this, mesh);
    this.design.goTo(complaint ? { ...mesh.case, complaint } : mesh.case, `${this.name}, ${mesh.name}`);
  }

  /** The parts of the scene and the meshes. */
  tree() {
    const { name, unit: { scene } } = this;
    this.facts = new Map();
    const shown = (text, seen) => make("li", {}, button(text, () => this.look(seen), { class: "part", "data-part": seen }));
    const part = (text, fact) => {
      this.facts.set(text, fact);
      return shown(text, text);
    };
    const tree = scene ? [shown(name, WHOLE), make("li", {}, ...branches(scene, part))] : [];
    const meshes = this.meshes.map((mesh) => (
      make("li", {}, button(`${mesh.name}, ${teeth(mesh.case)}`, () => this.openMesh(mesh), { class: "part" }), make("small", { "data-mesh": mesh.name }))));
    return make("ul", { class: "parts" }, ...tree, make("li", {}, branch("Meshes", meshes)));
  }

  /** Show what the service made of a file. */
  put(word, name, unit) {
    Object.assign(this, { word, name, unit });
    const { scene } = unit;
    const small = (text, action) => button(text, action, { class: "small" });
    const files = scene ? [small("Open scene", () => this.page.scene(name, unit)), small("Save scene", () => this.saveScene())] : [];
    this.summary = summary(name, unit);
    this.place.replaceChildren(
      ...unit.left_out.map((text) => make("p", { class: "alarm", role: "alert" }, `Left out of the scene: ${text}`)),
      this.tree(),
      make("p", { class: "hint", role: "status" }, this.summary),
      make("p", { class: "buttons" }, ...files, small("Save report", () => save(`${JSON.stringify(unit.lines, null, 1)}\n`, "import.json", "application/json"))),
      ...(unit.load_cases.length ? [folded("Load cases", loads(unit.load_cases))] : []),
      folded("What was refused, assumed, defaulted and derived", make("ul", {}, ...unit.summary.map((line) => make("li", {}, line)))),
    );
  }

  async saveScene() {
    await saveScene(await post("/v1/scenes/to-files", { inputs: { scene: this.unit.scene } }));
  }
}

/** @param {any} content a case */
const teeth = ({ pair }) => `${pair.pinion.teeth}/${pair.wheel.teeth}`;

/** @param {string} title @param {Node[]} items */
function branch(title, items) {
  const made = folded(title, make("ul", {}, ...items));
  made.open = true;
  return made;
}

/** What a housing is given by. @param {any} housing */
function housingWords(housing) {
  if (isSolid(housing)) return "housing";
  if (!housing.frf_file) return "housing by matrices, which have no surface to draw";
  return `housing by measured responses (${housing.frf_file.name}), which have no surface to draw`;
}

/** The parts of a scene: shafts with what sits on them, and housings. @param {any} scene @param {(name: string, fact: string) => HTMLElement} part */
function branches(scene, part) {
  const bearings = [...(scene.rolling_bearings ?? []), ...(scene.bushings ?? [])];
  const at = (item) => `on ${item.shaft}, at ${number(item.position_mm)} mm`;
  const shafts = (scene.shafts ?? []).flatMap((shaft) => {
    const on = (items) => items.filter((item) => item.shaft === shaft.name);
    const items = [
      ...on(scene.gears ?? []).map((gear) => part(gear.name, `${gear.name}: gear ${at(gear)}.`)),
      ...on(bearings).map((bearing) => part(bearing.name, `${bearing.name}: bearing ${at(bearing)}${bearing.catalog ? `, outside diameter ${number(bearing.catalog.outside_diameter_mm)} mm` : ""}.`)),
    ];
    const sections = shaft.sections ? `, ${shaft.sections.length} sections` : "";
    const row = part(shaft.name, `${shaft.name}: ${number(shaft.length_mm)} mm long, from ${vector(shaft.origin_mm ?? [0, 0, 0])} mm${sections}.`);
    row.append(make("ul", {}, ...items));
    return [row];
  });
  const housings = (scene.housings ?? []).map((housing) => part(housing.name, `${housing.name}: ${housingWords(housing)}.`));
  return [branch("Shafts", shafts), ...(housings.length ? [branch("Housing", housings)] : [])];
}

/** How many stages, and what became of the values. */
function summary(name, unit) {
  const count = (fate) => unit.lines.filter((line) => line.fate === fate).length;
  const fates = FATES.filter(count).map((fate) => `${count(fate)} ${fate}`).join(", ");
  const scene = unit.scene ? "" : " There is no scene: the report says why.";
  return `${name}: ${unit.cases.length} different stages; open a mesh. Values: ${fates}.${scene}`;
}

function loads(cases) {
  return make("ul", {}, ...cases.map((load) => {
    const forces = load.forces.map((force) => `${force.name} ${vector(force.force_n)} N, ${vector(force.moment_n_m)} N m`);
    return make("li", {}, [`${load.name}: ${number(load.torque_n_m)} N m`, `${number(load.speed_rpm)} rpm`, `${number(100 * load.share)} % of the time`, load.direction, ...forces].join("; "));
  }));
}

/** @param {number[]} values */
const vector = (values) => values.map((value) => number(value)).join(", ");
