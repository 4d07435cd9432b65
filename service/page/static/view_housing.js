// @ts-check
/** The surface of the housings of a scene where they stand, as their files have it: nothing need be computed. */

import { ask, patiently } from "./api.js";

const SHAPE = ["step_file", "mesh_file", "mesh_unit", "origin_mm", "x_axis", "z_axis"];

/** Whether a housing has the file of a solid: matrices have no surface. @param {any} housing */
export const isSolid = (housing) => Boolean(housing.step_file ?? housing.mesh_file);

/** @param {any} scene */
const solidsOf = (scene) => (scene.housings ?? []).filter(isSolid);

/** Whether a scene has a housing that can be drawn. @param {any} scene null: there is none */
export const isHoused = (scene) => Boolean(scene) && solidsOf(scene).length > 0;

/** What was answered last, by all that it depends on. */
let last = { shape: "", surface: Promise.resolve(null) };

/** @param {any} scene @returns {Promise<import("./view_motion.js").Surface | null>} null: it has no housing from a file @throws {import("./api.js").Problem} */
export function surfaceOf(scene) {
  const housings = solidsOf(scene);
  const shape = JSON.stringify(housings.map((housing) => SHAPE.map((name) => housing[name] ?? null)));
  if (shape !== last.shape) {
    const surface = housings.length ? patiently(() => ask("housing-surface", { housings })).then((answer) => answer.surface) : Promise.resolve(null);
    last = { shape, surface };
    surface.catch(() => { last = { shape: "", surface }; }); // asked once more next time
  }
  return last.surface;
}
