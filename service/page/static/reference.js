/** A result kept to compare others with: its flanks, asked for again at the torque that is looked at. */

import { Problem, post } from "./api.js";

/** Words for a pair as it is looked at: teeth, and what differs from the case. */
export function pairWords(known, question) {
  const { pinion, wheel } = known.case.pair;
  const parts = [`${pinion.teeth}/${wheel.teeth}`];
  for (const gear of ["pinion", "wheel"]) {
    const relief = question[gear]?.tip_relief_um ?? known.case.pair[gear].tip_relief_um;
    if (relief) parts.push(`${gear} relief ${Number(relief.toFixed(1))} µm`);
  }
  if (question.misalignment_um) parts.push(`misaligned ${question.misalignment_um} µm`);
  return `${parts.join(", ")} (${known.key.slice(0, 6)})`;
}

export class Reference {
  /**
   * @param {object} known the analysed pair
   * @param {object} question its flanks and misalignment
   */
  constructor(known, question) {
    this.key = known.key;
    this.question = question;
    this.words = pairWords(known, question);
    this.curve = null;
  }

  /** Its curve at a torque; null if it has none there (the reason is in `refusal`). */
  async at(torque, caller) {
    if (this.asked === torque) return this.curve;
    try {
      const body = { ...this.question, torque_n_m: [torque], caller };
      [this.curve] = (await post(`/v1/databases/${this.key}/ste`, body)).curves;
      this.refusal = "";
      this.asked = torque;
    } catch (problem) {
      if (!(problem instanceof Problem) || problem.status === 0 || problem.retryAfter) throw problem;
      this.curve = null;
      this.refusal = problem.message;
    }
    return this.curve;
  }
}
