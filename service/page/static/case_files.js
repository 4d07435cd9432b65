// @ts-check
/** Case files: opened into the form, saved from it. Files of units and scenes are told by name and content. */

import { Problem, ask, guarded, post } from "./api.js";
import { offerAsMade } from "./as_made.js";
import { byId, save } from "./elements.js";
import { OpenedUnit, isUnit } from "./unit.js";

/** What is offered among the fields of the case: a row each. */
const OFFERS = [
  offerAsMade,
];

const OF_SCENE = /^\s*\[\[shafts\]\]/m; // a table that scenes have and cases do not

export class CaseFiles {
  /**
   * @param {import("./design.js").Design} design
   * @param {ConstructorParameters<typeof OpenedUnit>[1] & {openScene: (chosen: any) => Promise<void>}} page of a gear unit
   */
  constructor(design, page) {
    Object.assign(this, { design, openScene: page.openScene });
    this.unit = new OpenedUnit(design, page);
    byId("export-toml").addEventListener("click", () => this.careful(async () => {
      const { toml } = await ask("to-toml", { inputs: { case: design.case } });
      save(toml, `${design.name || "case"}.toml`, "application/toml");
    }));
    for (const offer of OFFERS) offer(design, (action) => this.careful(action));
    byId("import-file").addEventListener("change", ({ target }) => this.careful(() => {
      const reading = this.open(target).finally(() => { if (design.reading === reading) design.reading = null; });
      return (design.reading = reading);
    }));
  }

  /** @param {any} chosen the control that a file was chosen with */
  async open(chosen) {
    const [file] = chosen.files;
    if (isUnit(file.name)) {
      await this.unit.open(file);
      chosen.value = "";
      return;
    }
    const text = await file.text();
    if (OF_SCENE.test(text)) {
      await this.openScene(chosen);
      return;
    }
    chosen.value = "";
    const content = file.name.endsWith(".json") ? parsed(text) : (await post("/v1/cases/from-toml", { toml: text })).case;
    this.design.goTo(content, file.name, { name: file.name.replace(/\.\w+$/, "") });
  }

  /** Do something that the service may refuse; say so at the form. */
  careful(action) {
    return guarded(action, (problem) => this.design.refuse(problem, { focus: true }));
  }
}

/** @param {string} text */
function parsed(text) {
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new Problem({ title: "No JSON", detail: `The file is no JSON: ${error.message}.`, status: 400 });
  }
}
