// @ts-check
/** What the jobs of this browser were about: the service keeps what they compute, not what they are called or made from. */

const PLACE = "lineofaction-jobs";
const MOST = 200;

/** @typedef {{name: string, case?: object}} About words for a job, and the case that it was submitted with */

/** @returns {Record<string, About>} */
function kept() {
  try {
    return JSON.parse(localStorage.getItem(PLACE) ?? "{}");
  } catch {
    return {}; // another page's, or storage is not allowed
  }
}

/** @param {string} id @param {About} about */
export function remember(id, about) {
  let entries = Object.entries({ ...kept(), [id]: about }).slice(-MOST);
  while (entries.length) {
    try {
      localStorage.setItem(PLACE, JSON.stringify(Object.fromEntries(entries)));
      return;
    } catch {
      entries = entries.slice(Math.ceil(entries.length / 2)); // full, or not allowed: then none is left
    }
  }
}

/** @param {string} id @returns {string} */
export const nameOf = (id) => kept()[id]?.name ?? "";

/** @param {string} id @returns {object | null} */
export const caseOf = (id) => kept()[id]?.case ?? null;

/** Words for the inputs of a job. */
export function words({ case: content, scene }) {
  if (scene) return `scene of ${scene.meshes?.length ?? 0} mesh${scene.meshes?.length === 1 ? "" : "es"}`;
  const { pinion, wheel, normal_module_mm: module } = content.pair ?? {};
  const loads = content.load?.torque_n_m;
  return `${pinion?.teeth}/${wheel?.teeth}, module ${module} mm${loads?.length ? `, up to ${Math.max(...loads)} N m` : ""}`;
}
