// @ts-check
/** A result kept to compare others with: its flanks, asked for again at the torque that is looked at. */

import { Problem, post } from "./api.js";
import { differences, flankWords } from "./comparison.js";

/** @typedef {{key: string, case: any}} Known an analyzed pair */
/** @typedef {{misalignment_um: number, pinion: object, wheel: object}} Question its flanks and misalignment, as moved by the sliders */

/** The case with the flanks that the sliders stand at. @param {Known} known @param {Question} question */
function designOf({ case: content }, { pinion, wheel }) {
  const pair = { ...content.pair, pinion: { ...content.pair.pinion, ...pinion }, wheel: { ...content.pair.wheel, ...wheel } };
  return { ...content, pair };
}

export class Reference {
  /** @param {Known} known @param {Question} question */
  constructor(known, question) {
    this.known = { key: known.key, case: known.case };
    this.question = question;
    this.refusal = "";
    this.curve = null;
  }

  /** What it is. @param {Iterable<import("./field.js").Field>} fields */
  words(fields) {
    const misaligned = this.question.misalignment_um ? `, misalignment ${this.question.misalignment_um} µm` : "";
    return `${flankWords(fields, designOf(this.known, this.question))}${misaligned} (${this.known.key.slice(0, 6)})`;
  }

  /**
   * Everything in which it differs from what is shown now.
   * @param {Iterable<import("./field.js").Field>} fields
   * @param {Known} known
   * @param {Question} question
   */
  differs(fields, known, question) {
    const changes = differences(fields, designOf(this.known, this.question), designOf(known, question))
      .filter(({ field }) => field.path[0] !== "load") // compared at the torque of the slider
      .map(({ words, before, now }) => `${words} ${before} (now ${now})`);
    if (this.question.misalignment_um === question.misalignment_um) return changes;
    return [...changes, `misalignment ${this.question.misalignment_um} µm (now ${question.misalignment_um} µm)`];
  }

  /** Its curve at a torque; null if it has none there (the reason is in `refusal`). */
  async at(torque, caller) {
    if (this.asked === torque) return this.curve;
    try {
      const body = { ...this.question, torque_n_m: [torque], flanks: true, caller };
      [this.curve] = (await post(`/v1/databases/${this.known.key}/ste`, body)).curves;
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
