// @ts-check
/** A gear unit of another tool (REXS): its stages, each opened into the form, its shafts, and the account. */

import { post } from "./api.js";
import { byId, dataTable, folded, make, number, save } from "./elements.js";

const FATES = ["taken", "assumed", "derived", "defaulted", "ignored", "refused"];
const ENDINGS = /\.(rexs|rexsj|rexsz|zip)$/i;

/** @param {string} name of a file */
export const isUnit = (name) => ENDINGS.test(name);

export class OpenedUnit {
  /**
   * @param {import("./design.js").Design} design
   * @param {(name: string, unit: {scene: object, load_cases: object[]}) => Promise<void>} openScene
   */
  constructor(design, openScene) {
    this.design = design;
    this.openScene = openScene;
    this.place = byId("unit");
  }

  /** @param {File} file */
  async open(file) {
    this.place.replaceChildren(); // the buttons of an earlier unit would open that one
    const body = { rexs_base64: await base64(file) };
    this.show(file.name, await post("/v1/units/open", body));
  }

  /** Show what the service made of a file. */
  show(name, unit) {
    const stages = unit.cases.map((stage) => make(
      "button", { type: "button", onclick: () => this.design.goTo(stage.case, `${name}, ${stage.name}`) }, stage.name,
    ));
    const scene = unit.scene ? [
      make("button", { type: "button", onclick: () => this.openScene(name, unit) }, "Open scene"),
      make("button", { type: "button", onclick: () => this.saveScene(unit.scene) }, "Save scene"),
    ] : [];
    const account = make("button", {
      type: "button", onclick: () => save(`${JSON.stringify(unit.lines, null, 1)}\n`, "import.json", "application/json"),
    }, "Save report");
    this.place.replaceChildren(
      ...unit.left_out.map((text) => make(
        "p", { class: "alarm", role: "alert" }, `Left out of the scene: ${text}`,
      )),
      make("p", { role: "status" }, summary(name, unit)),
      make("p", { class: "buttons" }, ...stages, ...scene, account),
      ...(unit.scene ? [shafts(unit.scene)] : []),
      ...(unit.load_cases.length ? [loads(unit.load_cases)] : []),
      folded("What was refused, assumed, defaulted and derived", make(
        "ul", {}, ...unit.summary.map((line) => make("li", {}, line)),
      )),
    );
    this.place.hidden = false;
    this.design.view.unit(unit.scene, (mesh) => this.design.goTo(mesh.case, `${name}, ${mesh.name}`));
  }

  async saveScene(scene) {
    const { toml } = await post("/v1/scenes/to-toml", { inputs: { scene } });
    save(toml, "scene.toml", "application/toml");
  }
}

/** How many stages, and what became of the values. */
function summary(name, unit) {
  const count = (fate) => unit.lines.filter((line) => line.fate === fate).length;
  const fates = FATES.filter(count).map((fate) => `${count(fate)} ${fate}`).join(", ");
  const scene = unit.scene ? "" : " There is no scene: the report says why.";
  return `${name}: ${unit.cases.length} different stages; open one below. Values: ${fates}.${scene}`;
}

function shafts(scene) {
  const rows = scene.shafts.map((shaft) => [
    shaft.name, number(shaft.length_mm), shaft.origin_mm.map((value) => number(value)).join(", "),
    String(shaft.sections?.length ?? 0),
  ]);
  return dataTable({ caption: "Shafts", head: ["shaft", "length, mm", "x, y, z, mm", "sections"], rows });
}

function loads(cases) {
  const rows = cases.map((load) => [
    load.name, number(load.torque_n_m), number(load.speed_rpm), number(100 * load.share), load.direction,
    load.forces.map((force) => `${force.name}: ${vector(force.force_n)}; ${vector(force.moment_n_m)}`).join(" | "),
  ]);
  const forces = "forces that differ: x, y, z, N; about x, y, z, N m";
  const head = ["case", "torque, N m", "speed, rpm", "share, %", "flanks", forces];
  return dataTable({ caption: "Load cases", head, rows });
}

/** @param {number[]} values */
const vector = (values) => values.map((value) => number(value)).join(", ");

/** @param {File} file */
async function base64(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  let text = "";
  for (let start = 0; start < bytes.length; start += 32_768) {
    text += String.fromCharCode(...bytes.subarray(start, start + 32_768));
  }
  return btoa(text);
}
