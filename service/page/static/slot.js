// @ts-check
/** A part of the page that shows one job: submitted from it or named by the address, watched, and shown when it has ended. */

import { guarded } from "./api.js";
import { DesignNote } from "./design_note.js";
import { make } from "./elements.js";
import { followed, orderOf, showFailure, submitted } from "./job.js";
import { sayMissing } from "./notice.js";

export class Slot {
  /**
   * @param {string} name in the address
   * @param {object} page
   * @param {import("./address.js").Address} page.address
   * @param {import("./design.js").Design} page.design
   * @param {object} parts
   * @param {HTMLElement} parts.progress
   * @param {HTMLElement} parts.result
   * @param {HTMLButtonElement} [parts.button] disabled while a job is under way
   * @param {(target: HTMLElement, reference: object, signal: AbortSignal, inputs: any) => Promise<void>} show
   */
  constructor(name, { address, design }, { progress, result, button }, show) {
    Object.assign(this, { name, address, design, progress, result, button, show });
    this.job = null;
    this.stopping = new AbortController();
    const words = make("div");
    result.before(words);
    this.note = new DesignNote(words, design);
  }

  /**
   * Submit a job, which becomes part of the address.
   * @param {string} process
   * @param {object | (() => object | Promise<object>)} inputs
   * @param {{expected?: number}} [facts] seconds that the plan predicts
   */
  async submit(process, inputs, { expected } = {}) {
    const { signal } = this.begin(null);
    await this.guarded(signal, async () => {
      if (this.design.reading) this.progress.append(make("p", { class: "hint", role: "status" }, "Waits for the file that is read."));
      await this.design.reading?.finally(() => this.progress.replaceChildren());
      const title = this.address.views.get("name") ?? "";
      const status = await submitted(this.progress, process, { inputs: typeof inputs === "function" ? await inputs() : inputs, title });
      if (signal.aborted) return;
      this.job = status.jobID;
      this.address.push({ [this.name]: this.job });
      await this.watch(signal, expected);
    });
  }

  /**
   * Show the job that the address names; null: none.
   * @param {string | null} job
   */
  follow(job) {
    if (job !== this.job) {
      const { signal } = this.begin(job);
      this.followed = job && this.guarded(signal, () => this.watch(signal), (problem) => this.missing(problem));
    }
    return this.followed;
  }

  /** Leave what was shown. */
  begin(job) {
    this.stopping.abort();
    this.stopping = new AbortController();
    this.job = job;
    this.note.of(null);
    this.progress.replaceChildren();
    this.result.replaceChildren();
    this.busy(false);
    return this.stopping;
  }

  /** @param {AbortSignal} signal @param {number} [expected] */
  async watch(signal, expected) {
    const reference = await followed(this.progress, this.job, { expected, signal });
    if (signal.aborted) return;
    const { inputs } = await orderOf(this.job);
    if (signal.aborted) return;
    this.note.of(inputs.case ?? null);
    await this.show(this.result, reference, signal, inputs);
  }

  /** Run until it is done or left; refusals are said in the place of the progress, or by `refused`. */
  async guarded(signal, action, refused = (problem) => this.refused(problem)) {
    this.busy(true);
    const unlessLeft = (then) => !signal.aborted && then();
    await guarded(action, (problem) => unlessLeft(() => refused(problem))).finally(() => unlessLeft(() => this.busy(false)));
  }

  /** What the address names has no result. @param {import("./api.js").Problem} problem */
  missing(problem) {
    sayMissing(`${this.name}: ${problem.message}`);
    if (problem.status !== 404) this.refused(problem);
  }

  /** @param {import("./api.js").Problem} problem */
  refused(problem) {
    showFailure(this.progress, problem);
  }

  /** @param {boolean} now */
  busy(now) {
    if (this.button) this.button.disabled = now;
  }
}
