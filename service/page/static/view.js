// @ts-check
/** What the design is, in three dimensions: the pair as it rolls, or the unit that was opened; and how it is steered. */

import { saidIn } from "./api.js";
import { button, byId, make } from "./elements.js";
import { isHoused, surfaceOf } from "./view_housing.js";
import { MOVING, Motions } from "./view_motion.js";
import { most, RollingPair } from "./view_pair.js";
import { drawable, Stage } from "./view_stage.js";
import { STILL, stillOf } from "./view_still.js";
import { gearboxOf } from "./view_unit.js";

const BENT = 200; // times
const READ = "The housing is read from its file.";

/** @typedef {import("./view_pair.js").Curve} Curve */

/** The picture in a part of the page, with what it is steered by. */
export class View {
  /** @param {HTMLElement} target hidden where the browser has no WebGL2: a drawing stands for the pair, a still picture for a unit */
  constructor(target) {
    this.target = target;
    /** @type {string | null} the motion of the result, by its number, as a word of the address */
    this.motion = null;
    target.hidden = !drawable();
    if (target.hidden) return;
    this.pair = new RollingPair();
    this.stage = new Stage(target, this.pair);
    this.words = make("p", { class: "view-words", role: "status" });
    this.scale = make("span", { class: "view-scale", hidden: true });
    this.pair.told = (words, map) => this.words.replaceChildren(...(map ? [map] : []), words);
    const roll = button("", () => this.stage.roll(!this.stage.rolls), { class: "small" });
    const say = () => { roll.textContent = this.stage.rolls ? "Stop" : "Roll"; };
    this.stopped = false;
    this.stage.canvas.addEventListener("rolls", () => {
      this.stopped = !this.stage.rolls;
      say();
      document.dispatchEvent(new Event("typed")); // the address says where it stands
    });
    say();
    byId("roll").addEventListener("input", () => {
      this.stage.subject.position = this.pair.position = Number(byId("roll").value);
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
    target.append(make("div", { class: "view-controls" }, roll, this.ofPair, this.motions.block), this.words);
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

  /**
   * Draw a gear unit with one of its parts marked, or the pair.
   * @param {any} scene null: the pair @param {string} [part] @param {(mesh: any) => void} [open] a mesh that is clicked
   * @param {((part: string, position: number) => void) | null} [slid] the part is moved along its shaft, mm
   */
  async see(scene, part = "", open = () => {}, slid = null) {
    const wanted = (this.wanted = { scene, part, open, slid });
    this.motions?.seen(scene);
    const drawn = scene && (scene === this.gearbox?.scene || this.gearbox?.follow(scene));
    const gearbox = scene && (drawn ? this.gearbox : await gearboxOf(scene, open));
    if (this.wanted !== wanted) return;
    this.gearbox = gearbox ?? this.gearbox;
    gearbox?.mark(part);
    if (gearbox) Object.assign(gearbox, { open, slid });
    if (!this.stage) {
      this.target.hidden = !gearbox;
      this.target.replaceChildren(...(gearbox ? [stillOf(gearbox, unitInWords(scene)), make("p", { class: "view-words", role: "status" }, STILL)] : []));
      return;
    }
    if (!this.stage.rolls && gearbox) gearbox.position = this.pair.position;
    this.stage.put(gearbox ?? this.pair);
    this.ofPair.hidden = Boolean(gearbox);
    const slides = gearbox?.middle ? ` Drag ${part} along its shaft, or press ← and →: 1 mm, with Shift 10 mm.` : "";
    const words = gearbox ? `The unit of the scene: click a mesh to open its pair.${slides}` : "";
    this.words.textContent = words;
    this.label(scene);
    if (gearbox && !gearbox.housing && isHoused(scene)) saidIn(this.words, () => this.house(gearbox, words));
  }

  /** Draw the housing of a unit, once its file is read. @param {any} gearbox @param {string} words about the unit */
  async house(gearbox, words) {
    this.words.textContent = READ;
    const surface = await surfaceOf(gearbox.scene);
    if (this.stage.subject !== gearbox || gearbox.housing) return;
    gearbox.house(surface);
    this.stage.frame();
    if (this.words.textContent === READ) this.words.textContent = words;
  }

  /** Show a scene whose housing is known by its file, as it is opened. @param {any} scene null: it has faults */
  open(scene) {
    if (this.stage && isHoused(scene)) saidIn(this.words, () => this.see(scene));
  }

  /** Draw a scene in place of what it was before an edit. */
  replace(before, scene) {
    const { wanted, motions } = this;
    if (motions?.before?.scene === before) motions.before.scene = scene;
    if (wanted?.scene === before) this.see(scene, wanted.part, wanted.open, wanted.slid);
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

/** @param {any} scene */
const unitInWords = ({ shafts, meshes }) => `Gear unit with ${shafts.length} shafts and ${meshes?.length ?? 0} meshes`;

/** Whether two outlines are of the same gears. @param {any} outline */
const outlined = (outline) => outline && JSON.stringify([outline.pinion, outline.wheel]);
