// @ts-check
/** What was computed for the parts of an address: the inputs of its jobs, the case of its table. */

import { get, guarded, patiently } from "./api.js";
import { orderOf } from "./job.js";

/** @typedef {{name: string, processID?: string, inputs: any}} Order a part of the address, and what was computed for it */

/** @param {string} hash of a table @returns {Promise<any>} its case and what else is known of it */
const tableOf = (hash) => patiently(() => get(`/v1/results/${hash}`));

/** What a table was computed for; null: there is no such table. @param {string} hash @returns {Promise<object | null>} */
export const caseOf = async (hash) => (await unlessMissing(tableOf(hash)))?.case ?? null;

/**
 * What was computed for the parts of an address, the newest first. What is not known is left out: it is said where it is shown.
 * @param {Map<string, string>} names
 * @returns {Promise<Order[]>}
 */
export async function ordersOf(names) {
  const orders = await Promise.all([...names].reverse().map(async ([name, value]) => {
    const order = name === "database" ? { inputs: { case: await caseOf(value) } } : await unlessMissing(orderOf(value));
    return { name, ...order };
  }));
  return orders.filter(({ inputs }) => inputs?.case || inputs?.scene);
}

/** The newest pair of them: of a case, or else of a scene. @param {Order[]} orders @returns {Promise<object | null>} */
export async function pairOf(orders) {
  for (const { inputs } of orders) if (inputs.case) return inputs.case;
  for (const { inputs: { scene } } of orders) {
    const { case: own, database_hash: hash } = scene.meshes?.[0] ?? {};
    if (own || hash) return own ?? caseOf(hash);
  }
  return null;
}

/** @param {Promise<any>} answer */
const unlessMissing = (answer) => guarded(() => answer, () => null);
