// @ts-check
/** Gears as made: the sheet of an inspection, or a draw within a class of ISO 1328, goes into the fields of the case. */

import { ask } from "./api.js";
import { button, byId, make } from "./elements.js";

const choice = (id, label, options) => make(
  "select", { id, "aria-label": label }, ...Object.entries(options).map(([value, text]) => make("option", { value }, text)));
const count = (id, label, value, most) => make(
  "label", {}, label, " ", make("input", { id, type: "number", min: "1", max: String(most), value: String(value) }));

/**
 * Offer it among the fields of the teeth as made.
 * @param {import("./design.js").Design} design
 * @param {(action: () => Promise<void>) => Promise<void>} careful says what is refused
 */
export function offerAsMade(design, careful) {
  const gear = choice("made-gear", "Measured gear", { pinion: "pinion", wheel: "wheel" });
  const loaded = choice("made-loaded", "Flanks that carry", { right: "right flanks carry", left: "left flanks carry" });
  const file = make("input", { class: "hidden-file", id: "made-file", type: "file", accept: ".csv,.txt,.mka", "aria-label": "Open the sheet of an inspection, CSV or MKA" });
  const stated = (how, note) => careful(async () => {
    const { case: made, left_out: left } = await ask("as-made", { inputs: { case: design.case }, ...how });
    design.show(made, { example: "", note: [note, ...left.map((text) => `Left out: ${text}`)].join(". ") });
    design.settled();
  });
  file.addEventListener("change", async () => {
    const [sheet] = file.files;
    const csv = await sheet.text();
    file.value = "";
    await stated({ measured: { csv, gear: gear.value, loaded: loaded.value } }, `The ${gear.value} as measured, ${sheet.name}`);
  });
  const draw = () => {
    const [within, seed] = ["made-class", "made-draw"].map((id) => /** @type {HTMLInputElement} */ (byId(id)).value);
    return stated({ tolerance_class: Number(within), seed: Number(seed) }, `Both gears drawn within class ${within} of ISO 1328-1, draw ${seed}`);
  };
  byId("node-teeth-as-made").prepend(
    make("div", { class: "row" }, file, make("label", { class: "button", for: file.id }, "Measured gear…"), gear, loaded),
    make("div", { class: "row" }, count("made-class", "ISO 1328-1 class", 6, 11), count("made-draw", "draw", 1, 999), button("Draw both gears", draw)),
  );
}
