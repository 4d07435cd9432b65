// @ts-check
/** What the design is, in three dimensions: the pair as it rolls, or the unit that was opened; and how it is steered. */

import { saidIn } from "./api.js";
import { button, byId, make } from "./elements.js";
import { context } from "./view_gl.js";
import { isHoused, surfaceOf } from "./view_housing.js";
import { MOVING, Motions } from "./view_motion.js";
import { most, RollingPair } from "./view_pair.js";
import { Stage } from "./view_stage.js";
import { STILL, stillOf } from "./view_still.js";
import { Gearbox, gearboxOf } from "./view_unit.js";

const BENT = 200; // times
const READ = "The housing is read from its file.";

/** @typedef {import("./view_pair.js").Curve} Curve */

/** The picture in a part of the page, with what it is steered by. */
export class View {
  /**
   * @param {HTMLElement} target hidden where the browser has no WebGL2: a drawing stands for the pair, a still picture for a unit
   * @param {() => void} back leaves a unit for the pair
   */
  constructor(target, back) {
    this.target = target;
    /** @type {Wanted} what is seen where no motion is shown */
    this.base = { scene: null };
    this.words = make("p", { class: "view-words", role: "status" });
    this.ofUnit = button("See the pair", back, { class: "small", hidden: true });
    /** @type {string | null} the motion of the result, by its number, as a word of the address */
    this.motion = null;
    target.hidden = !context;
    if (target.hidden) return;
    this.pair = new RollingPair();
    this.stage = new Stage(target, this.pair);
    this.scaleEnd = make("span", {});
    this.scale = make("span", { class: "view-scale", hidden: true }, make("span", { class: "view-scale-zero" }, "flank pressure 0"), this.scaleEnd);
    this.pair.told = (words, map) => this.words.replaceChildren(...(map ? [map] : []), words);
    const roll = button("", () => this.stage.roll(!this.stage.rolls), { class: "small" });
    const say = () => { roll.textContent = this.stage.rolls ? "Stop" : "Roll"; };
    this.stopped = false;
    this.stage.canvas.addEventListener("rolls", () => {
      this.stopped = !this.stage.rolls;
      if (this.stopped && Number(this.at) % 1 !== Number(byId("roll").value) % 1) this.stand(this.at);
      say();
      document.dispatchEvent(new Event("typed")); // the address says where it stands
    });
    say();
    this.stage.canvas.addEventListener("rolled", () => {
      byId("roll").value = String(this.stage.subject.position % 1);
      byId("roll").dispatchEvent(new Event("followed"));
    });
    byId("roll").addEventListener("input", () => {
      this.stage.subject.position = this.pair.position = Math.floor(this.stage.subject.position) + Number(byId("roll").value);
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
    this.motions = new Motions(this);
    target.append(make("div", { class: "view-controls" }, roll, this.ofPair, this.ofUnit, this.motions.block), this.words);
  }

  /** Where it stands, in base pitches, as a word of the address; null: nobody stopped it. */
  get at() {
    const position = this.stage ? this.stage.subject.position % 1 : Number(byId("roll").value);
    return (this.stage ? this.stopped : position) ? position.toFixed(2) : null;
  }

  /** Stand there. @param {string | undefined} at as in an address */
  stand(at) {
    if (at === undefined) return;
    byId("roll").value = at;
    byId("roll").dispatchEvent(new Event("input"));
  }

  /** @typedef {{scene: any, part?: string, open?: (mesh: any) => void, slid?: ((part: string, position: number) => void) | null}} Wanted a
   * unit by its scene, null: the pair; the part that is marked, what a click on a mesh does and what moves that part along its shaft, mm */

  /** Draw a gear unit with one of its parts marked, or the pair; where a motion is shown, once it is left. @param {Wanted} wanted */
  see(wanted) {
    this.base = wanted;
    return this.motions?.list.value ? undefined : this.present(wanted);
  }

  /** @param {Wanted} wanted */
  async present(wanted) {
    this.wanted = wanted;
    const { scene, open = () => {} } = wanted;
    await saidIn(this.words, async () => {
      const drawn = scene && (scene === this.gearbox?.scene || this.gearbox?.follow(scene));
      const unit = scene && (drawn ? this.gearbox : await gearboxOf(scene, open));
      if (this.wanted !== wanted) return;
      this.put(unit, wanted);
      if (unit && (unit.solid || isHoused(scene))) this.house(unit, wanted);
    });
  }

  /** @param {Gearbox | null} unit @param {Wanted} wanted */
  put(unit, { scene, part = "", open = () => {}, slid = null }) {
    this.ofUnit.hidden = !unit;
    this.gearbox = unit ?? this.gearbox;
    unit?.mark(part);
    if (unit) Object.assign(unit, { open, slid });
    this.words.textContent = unit ? inWords(unit, part, this.stage) : "";
    if (!this.stage) {
      this.target.hidden = !unit;
      this.target.replaceChildren(...(unit ? [stillOf(unit, unitInWords(scene)), this.ofUnit, this.words] : []));
      return;
    }
    if (!this.stage.rolls && unit) unit.position = this.pair.position;
    this.stage.put(unit ?? this.pair);
    this.ofPair.hidden = Boolean(unit);
    this.label(scene);
  }

  /** Draw the housing of a unit, once its file is read. @param {Gearbox} unit @param {Wanted} wanted */
  house(unit, wanted) {
    const words = this.words.textContent;
    return saidIn(this.words, async () => {
      this.words.textContent = READ;
      const surface = await surfaceOf(unit.scene);
      if (this.words.textContent === READ) this.words.textContent = words;
      if (this.wanted !== wanted || surface === unit.solid) return;
      unit.house(surface);
      if (this.stage) this.stage.frame(true);
      else this.put(unit, wanted);
    });
  }

  /** Draw a scene in place of what it was before an edit. */
  replace(before, scene) {
    if (this.base.scene === before) this.see({ ...this.base, scene });
  }

  /** Offer the motions of a result, if it has any, in the picture of its scene. @param {any} scene @param {any} result reference to it @param {AbortSignal} signal */
  async offer(scene, result, signal) {
    if (this.stage && MOVING.has(result.kind)) await this.motions.offer(scene, result, signal);
  }

  /** Say in words what is drawn. @param {any} scene null: the pair */
  label(scene) {
    const { pinion, wheel, internal } = this.pair.outline ?? { pinion: {}, wheel: {} };
    const what = scene ? `${unitInWords(scene)}, in motion`
      : `${pinion.teeth} teeth drive ${internal ? "a ring gear with " : ""}${wheel.teeth}, rolling in three dimensions`;
    this.stage.canvas.setAttribute("aria-label", `${what}. Drag or arrow keys turn the picture, wheel or + and − zoom, space stops and starts.`);
  }

  /** @param {any} outline answer of /v1/cases/outline, of the pair as typed */
  show(outline) {
    if (!this.stage) return;
    if (outlined(outline) === outlined(this.pair.outline)) return;
    this.pair.show(this.stage.gl, outline);
    this.draw();
    if (this.stage.subject !== this.pair) return;
    this.label(null);
    this.stage.frame();
  }

  /**
   * Draw the pressure of a live answer on the gears that it is of.
   * @param {Curve | null} curve @param {any} outline of the analyzed pair
   */
  press(curve, outline = null) {
    if (!this.stage) return;
    if (outline && !this.pair.outline) this.show(outline);
    if (outline && outlined(outline) !== outlined(this.of)) this.pair.top = 0;
    Object.assign(this, { curve, of: outline });
    this.draw();
  }

  draw() {
    const shown = this.curve && outlined(this.pair.outline) === outlined(this.of) ? this.curve : null;
    if (shown !== this.pair.curve) this.pair.press(this.stage.gl, shown);
    this.scale.hidden = !shown;
    this.scaleEnd.textContent = `${this.pair.top} MPa`;
    this.stage.canvas.dataset.pressed = String(shown ? most(shown.passage.pressure_mpa) : 0);
    this.stage.wake();
  }
}

/** What may be done with the picture of a unit. @param {Gearbox} unit @param {string} part that is marked @param {Stage | undefined} stage on which it moves */
function inWords({ stages, middle, scene }, part, stage) {
  if (!stage) return STILL;
  const pairs = stages.length ? "The unit of the scene: click a mesh to open its pair." : "The unit of the scene, which has no mesh with a pair to draw.";
  const planets = scene.planets?.length ? " Of planets the first is drawn." : "";
  return pairs + planets + (middle ? ` Drag ${part} along its shaft, or press ← and →: 1 mm, with Shift 10 mm.` : "");
}

/** @param {any} scene */
const unitInWords = ({ shafts = [], meshes = [] }) => `Gear unit with ${shafts.length} shaft${shafts.length === 1 ? "" : "s"} and ${meshes.length} mesh${meshes.length === 1 ? "" : "es"}`;

/** Whether two outlines are of the same gears. @param {any} outline */
const outlined = (outline) => outline && JSON.stringify([outline.pinion, outline.wheel]);
