// @ts-check
/** The canvas of the three-dimensional views: one subject at a time, drawn when something moves and only then. */

import { Camera } from "./view_camera.js";
import { context } from "./view_gl.js";
import { programsOf } from "./view_pair.js";

const SLOW = 40; // ms a frame, beyond which fewer pixels are drawn while it moves
const LEAST = 0.75; // of the pixels across
const QUICK = 150; // ms a frame, below which a still picture is fine
const FINE = 2; // pixels drawn a pixel shown where nothing moves: edges are smooth
const SETTLED = 250; // ms after which a picture at rest becomes fine: answers to sliders do not wait for it
const SLIDES = { ArrowLeft: -1, ArrowRight: 1 }; // mm
const FINEST = 0.1; // mm of a drag
const SAID = 250; // ms between two sayings of where it rolls
const CALM = matchMedia("(prefers-reduced-motion: reduce)");

/**
 * @typedef {object} Subject what is drawn
 * @property {(gl: WebGL2RenderingContext, programs: any) => void} begin make what it needs
 * @property {(gl: WebGL2RenderingContext) => void} end let go of it
 * @property {(gl: WebGL2RenderingContext, frame: {view: Float32Array, back: number[], moving: boolean, picking: boolean | "marked"}) => void} draw
 * @property {(seconds: number) => void} advance
 * @property {(texel: Uint8Array | null) => void} picked what is drawn at a place that was clicked; null: nothing
 * @property {(camera: Camera) => void} frame
 * @property {(mm: number) => void} [slide] move the part that is marked along its shaft
 * @property {number[] | null} [middle] of that part; null: it has no place on a shaft
 */

export class Stage {
  /** @param {HTMLElement} target @param {Subject} subject */
  constructor(target, subject) {
    this.subject = subject;
    this.camera = new Camera();
    this.gl = context;
    this.canvas = /** @type {HTMLCanvasElement} */ (this.gl.canvas);
    Object.assign(this.canvas, { className: "view", tabIndex: 0, role: "img" });
    this.rolls = !CALM.matches;
    this.moving = false;
    this.seen = false;
    this.part = LEAST; // the first frames wait for what the browser makes of the shaders
    target.append(this.canvas);
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => this.begin());
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.camera.follow(this.canvas, { moved: () => this.moved(), clicked: (x, y) => this.pick(x, y), dragged: (event) => this.dragged(event) });
    new ResizeObserver(() => this.wake()).observe(this.canvas);
    new IntersectionObserver(([entry]) => {
      this.seen = entry.isIntersecting;
      this.wake();
    }).observe(this.canvas);
    document.addEventListener("visibilitychange", () => this.wake());
    this.begin();
  }

  begin() {
    this.programs = programsOf(this.gl);
    this.subject.begin(this.gl, this.programs);
    this.wake();
  }

  /** Draw a subject in place of another. @param {Subject} subject */
  put(subject) {
    if (subject !== this.subject) {
      const before = this.subject;
      before.end(this.gl);
      this.subject = subject;
      subject.begin(this.gl, this.programs);
      this.frame(before.constructor === subject.constructor);
    }
    this.wake();
  }

  /** Look at the whole subject. @param {boolean} [kept] from where the last one was seen */
  frame(kept = false) {
    const { yaw, pitch, distance, home } = this.camera;
    this.subject.frame(this.camera);
    if (kept) Object.assign(this.camera, { yaw, pitch, distance: this.camera.distance * (distance / home.distance) });
    this.wake();
  }

  /** @param {boolean} now whether it rolls */
  roll(now) {
    this.rolls = now;
    this.canvas.dispatchEvent(new Event("rolls"));
    this.wake();
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.key === " ") this.roll(!this.rolls);
    else if (SLIDES[event.key] && this.subject.middle) this.subject.slide(SLIDES[event.key] * (event.shiftKey ? 10 : 1));
    else if (event.ctrlKey || event.metaKey || event.altKey || !this.camera.press(event.key)) return;
    else this.moved();
    event.preventDefault();
  }

  /** What a pointer drags that is pressed: the part that is marked, along its shaft; null: nothing. @param {PointerEvent} event */
  dragged({ shiftKey, offsetX: x, offsetY: y }) {
    const { subject, camera, canvas } = this;
    if (!subject.middle || !(shiftKey || this.texel(x, y, "marked")[0])) return null;
    let rest = 0;
    return (right, down) => {
      const along = camera.along(subject.middle, canvas);
      rest += along[0] * right + along[1] * down;
      const whole = Math.round(rest / FINEST) * FINEST;
      if (whole) subject.slide(whole);
      rest -= whole;
    };
  }

  moved() {
    this.moving = true;
    clearTimeout(this.rest);
    this.rest = setTimeout(() => {
      this.moving = false;
      this.wake();
    }, 200);
    this.wake();
  }

  /** Draw once more, and go on while it rolls. */
  wake() {
    if (this.asked || document.hidden || !this.seen) return;
    this.asked = requestAnimationFrame((now) => this.turn(now));
  }

  turn(now) {
    this.asked = 0;
    const passed = this.last ? now - this.last : 0;
    this.last = this.rolls ? now : 0;
    if (this.rolls) this.subject.advance(Math.min(passed, 100) / 1000);
    this.adapt(passed);
    this.paint(false);
    clearTimeout(this.settling);
    if (!this.rolls && !this.moving) this.settling = setTimeout(() => this.paint(false, true), SETTLED);
    this.canvas.dataset.frames = String(Number(this.canvas.dataset.frames ?? 0) + 1);
    if (!this.rolls) return;
    this.wake();
    if (now - (this.said ?? 0) < SAID) return;
    this.said = now;
    this.canvas.dispatchEvent(new Event("rolled"));
  }

  /** Fewer pixels where a frame takes long, all of them where nothing moves. @param {number} passed ms */
  adapt(passed) {
    if (passed > 0 && passed < 1000) this.took = 0.8 * (this.took ?? passed) + 0.2 * passed;
    if (!this.rolls && !this.moving) this.part = 1;
    else if (this.took > SLOW) this.part = Math.max(LEAST, 0.97 * this.part);
    else if (this.took < 0.5 * SLOW) this.part = Math.min(1, 1.01 * this.part);
  }

  /** @param {boolean | "marked"} picking which parts are drawn to be picked @param {boolean} [settled] whether nothing moves any more */
  paint(picking, settled = false) {
    const { gl, canvas, camera } = this;
    const scale = settled ? Math.max(devicePixelRatio, this.took > QUICK ? 1 : FINE) : Math.min(devicePixelRatio, 2) * (picking ? 1 : Math.round(8 * this.part) / 8);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.max(1, Math.round(scale * size)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    this.subject.draw(gl, { view: camera.matrix(width / height), back: camera.back, moving: this.moving || this.rolls, picking });
  }

  /** Say the subject what stands at a place of the canvas. */
  pick(x, y) {
    const texel = this.texel(x, y, true);
    this.subject.picked(texel[0] ? texel : null);
  }

  /** What stands at a place of the canvas. @param {true | "marked"} picking */
  texel(x, y, picking) {
    const { gl, canvas } = this;
    const texel = new Uint8Array(4);
    this.paint(picking);
    const scale = canvas.width / canvas.clientWidth;
    gl.readPixels(Math.round(scale * x), canvas.height - 1 - Math.round(scale * y), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, texel);
    this.paint(false);
    this.wake();
    return texel;
  }
}
