/** What the jobs of this browser were about: the service keeps what they compute, not what they are called. */

const PLACE = "lineofaction-jobs";
const MOST = 200;

function kept() {
  try {
    return JSON.parse(localStorage.getItem(PLACE)) ?? {};
  } catch {
    return {}; // another page's, or storage is not allowed
  }
}

export function remember(id, name) {
  const names = Object.entries({ ...kept(), [id]: name }).slice(-MOST);
  try {
    localStorage.setItem(PLACE, JSON.stringify(Object.fromEntries(names)));
  } catch {
    // storage is full or not allowed: the list goes without names
  }
}

export const nameOf = (id) => kept()[id] ?? "";

/** Words for the inputs of a job. */
export function words({ case: content, scene }) {
  if (scene) return `scene of ${scene.meshes?.length ?? 0} mesh${scene.meshes?.length === 1 ? "" : "es"}`;
  const { pinion, wheel, normal_module_mm: module } = content.pair ?? {};
  const loads = content.load?.torque_n_m;
  return `${pinion?.teeth}/${wheel?.teeth}, module ${module} mm${loads?.length ? `, up to ${Math.max(...loads)} N m` : ""}`;
}
