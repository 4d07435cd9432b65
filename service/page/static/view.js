// @ts-check
/** What the design is, in three dimensions: the pair as it rolls, or the unit that was opened; and how it is steered. */

import { byId, make } from "./elements.js";
import { most, RollingPair } from "./view_pair.js";
import { drawable, Stage } from "./view_stage.js";
import { gearboxOf } from "./view_unit.js";

const BENT = 200; // times

/** @typedef {import("./view_pair.js").Curve} Curve */

/** The picture in a part of the page, with what it is steered by. */
export class View {
  /** @param {HTMLElement} target hidden where the browser has no WebGL2: the drawing stands for it */
  constructor(target) {
    target.hidden = !drawable();
    if (target.hidden) return;
    this.pair = new RollingPair();
    this.stage = new Stage(target, this.pair);
    this.words = make("p", { class: "view-words", role: "status" });
    this.scale = make("span", { class: "view-scale", hidden: true });
    this.pair.told = (words, map) => this.words.replaceChildren(...(map ? [map] : []), words);
    const roll = make("button", { type: "button", class: "small", onclick: () => this.stage.roll(!this.stage.rolls) }, "");
    const say = () => {
      roll.textContent = this.stage.rolls ? "Stop" : "Roll";
    };
    this.stage.canvas.addEventListener("rolls", say);
    say();
    byId("roll").addEventListener("input", () => {
      this.pair.position = Number(byId("roll").value);
      this.stage.roll(false);
    });
    const choice = (text, checked, changed) => make("label", {}, make("input", { type: "checkbox", checked, "data-unkept": true, onchange: (event) => {
      changed(event.target.checked);
      this.stage.wake();
    } }), ` ${text}`);
    this.ofPair = make("span", { class: "view-controls" },
      choice(`bent × ${BENT}`, false, (on) => { this.pair.bent = on ? BENT : 0; }),
      choice("see through the wheel", true, (on) => { this.pair.through = on; }),
      this.scale);
    target.append(make("div", { class: "view-controls" }, roll, this.ofPair), this.words);
  }

  /** Draw a gear unit in place of the pair, until another pair is shown. @param {any} scene @param {(mesh: any) => void} open a mesh that is clicked */
  async unit(scene, open) {
    if (!this.stage || !scene) return;
    const gearbox = await gearboxOf(scene, (mesh) => {
      this.back();
      open(mesh);
    });
    this.back();
    gearbox.begin(this.stage.gl);
    this.stage.subject = gearbox;
    this.ofPair.hidden = true;
    this.words.textContent = "The unit of the scene: click a mesh to open its pair.";
    this.stage.canvas.setAttribute("aria-label", `Gear unit with ${scene.shafts.length} shafts and ${scene.meshes.length} meshes, in motion. Drag or arrow keys turn the picture, wheel or + and − zoom, space stops and starts.`);
    this.stage.frame();
  }

  /** Draw the pair. */
  back() {
    if (this.stage.subject === this.pair) return;
    this.stage.subject.end(this.stage.gl);
    this.stage.subject = this.pair;
    this.ofPair.hidden = false;
    this.words.textContent = "";
    this.stage.frame();
  }

  /** @param {any} outline answer of /v1/cases/outline, of the pair as typed */
  show(outline) {
    if (!this.stage) return;
    if (outlined(outline) === outlined(this.pair.outline)) return;
    this.pair.show(this.stage.gl, outline);
    this.back();
    const { pinion, wheel, internal } = outline;
    this.stage.canvas.setAttribute("aria-label", `${pinion.teeth} teeth drive ${internal ? "a ring gear with " : ""}${wheel.teeth}, rolling in three dimensions. Drag or arrow keys turn the picture, wheel or + and − zoom, space stops and starts.`);
    this.draw();
    this.stage.frame();
  }

  /**
   * Draw the pressure of a live answer on the gears that it is of.
   * @param {Curve | null} curve @param {any} outline of the analyzed pair
   */
  press(curve, outline = null) {
    if (!this.stage) return;
    if (outline && outlined(outline) !== outlined(this.of)) this.pair.top = 0;
    Object.assign(this, { curve, of: outline });
    this.draw();
  }

  draw() {
    const shown = this.curve && outlined(this.pair.outline) === outlined(this.of) ? this.curve : null;
    if (shown !== this.pair.curve) this.pair.press(this.stage.gl, shown);
    this.scale.hidden = !shown;
    this.scale.textContent = `${this.pair.top} MPa`;
    this.stage.canvas.dataset.pressed = String(shown ? most(shown.passage.pressure_mpa) : 0);
    this.stage.wake();
  }
}

/** Whether two outlines are of the same gears. @param {any} outline */
const outlined = (outline) => outline && JSON.stringify([outline.pinion, outline.wheel]);
