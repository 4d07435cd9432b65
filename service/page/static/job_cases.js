// @ts-check
/** The cases from which this browser submitted its jobs: the service keeps what they compute, not what the form held. */

const PLACE = "lineofaction-jobs";
const MOST = 200;

/** @returns {Record<string, {case?: object}>} */
function kept() {
  try {
    return JSON.parse(localStorage.getItem(PLACE) ?? "{}");
  } catch {
    return {}; // another page's, or storage is not allowed
  }
}

/** @param {string} id @param {object} [content] */
export function remember(id, content) {
  let entries = Object.entries({ ...kept(), [id]: { case: content } }).slice(-MOST);
  while (entries.length) {
    try {
      localStorage.setItem(PLACE, JSON.stringify(Object.fromEntries(entries)));
      return;
    } catch {
      entries = entries.slice(Math.ceil(entries.length / 2)); // full, or not allowed: then none is left
    }
  }
}

/** @param {string} id @returns {object | null} */
export const caseOf = (id) => kept()[id]?.case ?? null;
