// @ts-check
/** A camera that orbits about a point: its matrix, and how pointer, wheel and keys move it. */

const FIELD = 1 / Math.tan((15 * Math.PI) / 180); // half of the field of view, upright
const STEEPEST = 1.5; // rad
const STEEPLY = 0.2; // of a length across the picture, at which one along z is taken to be seen at least
const STEP = 0.08; // rad a key
const STILL = 4; // pixels within which a press is a click

/** @typedef {[number, number, number]} Point */

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const clamped = (value, low, high) => Math.min(Math.max(value, low), high);

export class Camera {
  constructor() {
    this.look([0, 0, 0], 100);
  }

  /**
   * Stand so that a ball fills the picture, or what is wider than high.
   * @param {Point} center @param {number} radius half of what is seen upright @param {number} [yaw] about y, from +z to +x @param {number} [pitch] upwards
   * @param {number} [closer] part of the distance to the whole ball
   * @param {{reach?: number, lying?: boolean}} [size] half of what is seen across; whether y lies across the picture, to the left
   */
  look(center, radius, yaw = 0.7, pitch = 0.3, closer = 1, { reach = radius, lying = false } = {}) {
    Object.assign(this, { center, radius, reach, lying, yaw, pitch, distance: closer * 1.1 * FIELD * radius });
    this.home = { center, yaw, pitch, distance: this.distance };
  }

  /** @returns {Point} from the center towards the eye */
  get back() {
    const flat = Math.cos(this.pitch);
    return [Math.sin(this.yaw) * flat, Math.sin(this.pitch), Math.cos(this.yaw) * flat];
  }

  /** The matrix (16, by columns) from the world to clip coordinates. @param {number} aspect width over height */
  matrix(aspect) {
    const { back, center, distance, radius, reach } = this;
    const level = [Math.cos(this.yaw), 0, -Math.sin(this.yaw)];
    const steep = [back[1] * level[2] - back[2] * level[1], back[2] * level[0] - back[0] * level[2], back[0] * level[1] - back[1] * level[0]];
    const [right, up] = this.lying ? [steep.map((value) => -value), level] : [level, steep];
    const eye = center.map((value, k) => value + distance * back[k]);
    const [far, near] = [distance + 3 * reach, Math.max(0.01 * distance, distance - 3 * reach)];
    const [depth, shift] = [(far + near) / (near - far), (2 * far * near) / (near - far)];
    const row = (axis, scale, more = 0) => [...axis.map((value) => scale * value), -scale * dot(axis, eye) + more];
    const field = FIELD * Math.min(1, (aspect * radius) / reach); // a narrow picture shows as much
    const rows = [row(right, field / aspect), row(up, field), row(back, depth, shift), row(back, -1)];
    return new Float32Array([0, 1, 2, 3].flatMap((column) => rows.map((values) => values[column])));
  }

  /** Turn with the pointer. @param {number} across rad to the right of the picture @param {number} down rad */
  turn(across, down) {
    const [about, over] = this.lying ? [down, -across] : [across, down];
    this.yaw -= about * (this.lying ? -1 : 1);
    this.pitch = clamped(this.pitch + over, -STEEPEST, STEEPEST);
  }

  zoom(factor) {
    this.distance = clamped(this.distance * factor, 0.15 * this.radius, 12 * this.radius);
  }

  /** @param {string} key @returns {boolean} whether it moves the camera */
  press(key) {
    const moves = {
      ArrowLeft: () => this.turn(-STEP, 0), ArrowRight: () => this.turn(STEP, 0), ArrowUp: () => this.turn(0, -STEP), ArrowDown: () => this.turn(0, STEP),
      "+": () => this.zoom(0.9), "-": () => this.zoom(1 / 0.9), Home: () => Object.assign(this, this.home),
    };
    moves[key]?.();
    return key in moves;
  }

  /**
   * How a point that moves along z moves over a picture. @param {number[]} point @param {{clientWidth: number, clientHeight: number}} size in CSS pixels
   * @returns {[number, number]} mm along z a pixel to the right and a pixel down
   */
  along([x, y, z], { clientWidth: width, clientHeight: height }) {
    const view = this.matrix(width / height);
    const seen = (depth) => {
      const [across, up, , w] = [0, 1, 2, 3].map((k) => view[k] * x + view[4 + k] * y + view[8 + k] * depth + view[12 + k]);
      return [(0.5 * width * across) / w, (-0.5 * height * up) / w];
    };
    const [from, to] = [seen(z), seen(z + 1)];
    const [right, down] = [to[0] - from[0], to[1] - from[1]];
    const least = (STEEPLY * FIELD * Math.min(width, height)) / (2 * this.distance); // where one looks along it
    const size = Math.max(Math.hypot(right, down), least) ** 2;
    return [right / size, down / size];
  }

  /**
   * Follow the pointers over a canvas: one turns or drags what it holds, two or the wheel zoom.
   * @param {HTMLCanvasElement} canvas
   * @param {{moved: () => void, clicked: (x: number, y: number) => void, dragged: (event: PointerEvent) => ((right: number, down: number) => void) | null}} told
   * places in CSS pixels from the upper left
   */
  follow(canvas, { moved, clicked, dragged }) {
    /** @type {Map<number, {x: number, y: number}>} */
    const held = new Map();
    let way = 0;
    /** @type {((right: number, down: number) => void) | null} */
    let drag = null;
    const apart = () => {
      const [a, b] = [...held.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    canvas.addEventListener("pointerdown", (event) => {
      const { pointerId, clientX: x, clientY: y } = event;
      canvas.setPointerCapture(pointerId);
      held.set(pointerId, { x, y });
      way = held.size > 1 ? Infinity : 0;
      drag = held.size > 1 ? null : dragged(event);
    });
    canvas.addEventListener("pointermove", ({ pointerId, clientX: x, clientY: y }) => {
      const before = held.get(pointerId);
      if (!before) return;
      const distance = held.size > 1 ? apart() : 0;
      held.set(pointerId, { x, y });
      way += Math.hypot(x - before.x, y - before.y);
      if (distance) this.zoom(distance / apart());
      else if (drag) drag(x - before.x, y - before.y);
      else this.turn(0.008 * (x - before.x), 0.008 * (y - before.y));
      moved();
    });
    canvas.addEventListener("pointerup", ({ pointerId, offsetX, offsetY }) => {
      if (held.delete(pointerId) && way < STILL) clicked(offsetX, offsetY);
    });
    canvas.addEventListener("pointercancel", ({ pointerId }) => held.delete(pointerId));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(1.001 ** event.deltaY);
      moved();
    }, { passive: false });
  }
}
