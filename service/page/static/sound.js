// @ts-check
/** The sound of a plot of a result: fetched when somebody wants to hear it. */

import { file, patiently, saidIn } from "./api.js";
import { button, make } from "./elements.js";
import { orderTone } from "./order_tone.js";
import { joined } from "./player.js";

/** @type {Map<HTMLAudioElement, string>} addresses of what was fetched, by where it plays */
const held = new Map();

/** Let go of sounds that have left the page. */
function swept() {
  for (const [player, url] of held) {
    if (player.isConnected) continue;
    URL.revokeObjectURL(url);
    held.delete(player);
  }
}

/**
 * A button that fetches the sounds of a figure and puts their players in its place.
 * @param {HTMLElement} node its plot
 * @param {{title: string, sound: import("./player.js").Sound, plot: {data: any[]}}} figure
 * @param {{href: string, hash: string, against?: string}} result
 */
export function soundBlock(node, { title, sound, plot }, result) {
  const line = make("span", { class: "fault", role: "status" });
  const listen = async () => {
    asked.disabled = true;
    const players = await saidIn(line, () => Promise.all(sound.tracks.map((track, k) => fetched(track, k, result))));
    asked.disabled = false;
    if (!players) return;
    group.prepend(...players.map((player, k) => make("label", {}, `${sound.tracks[k].name} `, player)));
    row.remove();
    joined(group, node, sound);
    players[0].focus();
  };
  const asked = button("Listen", listen, { class: "small", "aria-label": `Listen to: ${title}` });
  const row = make("div", { class: "row" }, asked, line);
  const group = make("div", { class: "player", role: "group", "aria-label": `Sound: ${title}` }, row, make("p", { class: "hint" }, sound.caption));
  if (plot.data[0].type === "heatmap") group.append(orderTone(node, { title, sound }));
  return group;
}

/**
 * The player of one track: the first is of the result, the second of the one it is compared with.
 * @param {import("./player.js").Track} track @param {number} k @param {{hash: string, against?: string}} result
 */
async function fetched(track, k, { hash, against }) {
  const [own, other] = k === 0 ? [hash, against] : [against, hash];
  const query = new URLSearchParams({ ...track.query, ...(other ? { against: other } : {}) });
  const content = await patiently(() => file(`/v1/results/${own}/sound?${query}`, "audio/wav"));
  swept();
  const url = URL.createObjectURL(content);
  const player = /** @type {HTMLAudioElement} */ (make("audio", { controls: true, preload: "metadata", src: url }));
  held.set(player, url);
  return player;
}
