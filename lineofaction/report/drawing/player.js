// @ts-check
/** The sound of a plot: a cursor where it is, a click where it shall be, two sounds in turn at one place. */

const STILL = 4; // pixels between press and release of a click: a longer way zooms

/** @typedef {{name: string, query: Record<string, string>, time: number[], along: number[], mesh_hz: number[] | null}} Track */
/** @typedef {{caption: string, tracks: Track[]}} Sound */

/** Where a value is that is nearest to another. @param {number[]} values @param {number} value */
export const nearest = (values, value) => values.reduce((best, each, k) => (Math.abs(each - value) < Math.abs(values[best] - value) ? k : best), 0);

/**
 * A piecewise linear function of places that rise and fall, beyond all of them that of the nearest.
 * @param {number[]} places @param {number[]} values @param {number} x
 */
export function linear(places, values, x) {
  const last = places.length - 1;
  const k = places.findIndex((place, n) => n < last && (place - x) * (places[n + 1] - x) <= 0);
  if (k < 0) return values[nearest(places, x)];
  const step = places[k + 1] - places[k];
  return values[k] + (step ? (x - places[k]) / step : 0) * (values[k + 1] - values[k]);
}

/**
 * Join the audio elements in a group to a plot: one after the other, each in the order of the tracks.
 * @param {HTMLElement} group @param {any} node the plot @param {Sound} sound
 */
export function joined(group, node, sound) {
  const players = [...group.querySelectorAll("audio")];
  const cursor = Object.assign(document.createElement("div"), { className: "cursor" });
  const place = document.createElement("output");
  let chosen = 0;
  const value = () => linear(sound.tracks[chosen].time, sound.tracks[chosen].along, players[chosen].currentTime);
  /** @param {number} there */
  const timeOf = (there) => linear(sound.tracks[chosen].along, sound.tracks[chosen].time, there);

  const move = () => {
    const area = node.querySelector(".nsewdrag")?.getBoundingClientRect();
    const { range, title } = node.layout?.xaxis ?? {};
    if (!area || !range) return;
    if (cursor.parentElement !== node) node.append(cursor);
    node.style.position = "relative";
    const frame = node.getBoundingClientRect();
    const part = (value() - range[0]) / (range[1] - range[0]);
    cursor.hidden = !(part >= 0 && part <= 1);
    Object.assign(cursor.style, {
      left: `${area.left - frame.left + part * area.width}px`, top: `${area.top - frame.top}px`, height: `${area.height}px`,
    });
    place.textContent = `${value().toPrecision(4)} ${String(title?.text ?? "").split(", ").pop()}`;
  };
  const run = () => {
    move();
    if (!players[chosen].paused && node.isConnected) requestAnimationFrame(run);
  };
  /** @param {number} next */
  const choose = (next) => {
    const [here, playing] = [value(), !players[chosen].paused];
    players[chosen].pause();
    chosen = next;
    players.forEach((player, k) => { (player.closest("label") ?? player).hidden = k !== chosen; });
    players[chosen].currentTime = timeOf(here);
    if (playing) players[chosen].play();
    move();
  };
  /** @param {PointerEvent} down */
  const press = (down) => {
    const area = node.querySelector(".nsewdrag")?.getBoundingClientRect();
    const range = node.layout?.xaxis?.range;
    if (!area || !range || down.clientY < area.top || down.clientY > area.bottom) return;
    /** @param {PointerEvent} up */
    const release = (up) => {
      const part = (up.clientX - area.left) / area.width;
      if (Math.hypot(up.clientX - down.clientX, up.clientY - down.clientY) > STILL || part < 0 || part > 1) return;
      players[chosen].currentTime = timeOf(range[0] + part * (range[1] - range[0]));
      move();
    };
    addEventListener("pointerup", release, { once: true, capture: true });
  };
  node.addEventListener("pointerdown", press, true); // plotly.js takes what a press starts
  for (const player of players) {
    player.addEventListener("play", run);
    for (const event of ["seeked", "loadedmetadata"]) player.addEventListener(event, move);
  }
  if (players.length > 1) group.prepend(switchOf(sound, choose));
  (group.querySelector("p") ?? group).before(place);
  if (players.length > 1) choose(0);
}

/**
 * Buttons of which one is chosen: which of the sounds is heard.
 * @param {Sound} sound @param {(k: number) => void} choose
 */
function switchOf(sound, choose) {
  const set = document.createElement("fieldset");
  set.append(Object.assign(document.createElement("legend"), { textContent: "Hear" }));
  const name = `hear-${Math.random().toString(36).slice(2)}`;
  sound.tracks.forEach((track, k) => {
    const label = document.createElement("label");
    const button = Object.assign(document.createElement("input"), { type: "radio", name, checked: k === 0 });
    button.addEventListener("change", () => choose(k));
    label.append(button, ` ${track.name}`);
    set.append(label);
  });
  return set;
}
