/** The jobs of the service as a gallery, newest first: their ripple, how far they are, reopened or cancelled. */

import { Problem, get, pause, saidIn } from "./api.js";
import { button, byId, make } from "./elements.js";
import { ENDED, cancelled, stateOf } from "./job.js";
import { headline } from "./job_headline.js";
import { called, label, renamed, search } from "./job_label.js";

const AT_ONCE = 10;
const OPENED = { successful: "Open", failed: "Why" };
const COMPARED = new Set(["analyze", "simulate"]); // processes whose results are compared
const AGAIN = 3000; // milliseconds after which jobs that have not ended are looked at again

export class Jobs {
  /**
   * @param {(job: object) => Promise<void>} open shows what came of a job
   * @param {(first: object, second: object) => Promise<void>} compare shows what differs between two
   */
  constructor(open, compare) {
    this.open = open;
    this.compare = compare;
    this.first = null; // job that another one is to be compared with
    this.shown = AT_ONCE;
    this.unfolded = new Set(); // batches whose jobs are shown
    this.line = byId("jobs-line");
    document.addEventListener("jobs-changed", () => this.refresh());
    this.search = byId("jobs-search");
    this.search.addEventListener("change", () => this.refresh());
    byId("jobs-more").addEventListener("click", () => {
      this.shown += AT_ONCE;
      this.refresh();
    });
  }

  /** Look at the list, and go on looking while jobs are under way. */
  async refresh() {
    const turn = (this.turn = (this.turn ?? 0) + 1);
    for (;;) {
      try {
        const { jobs } = await get(`/v1/jobs?once=true&limit=${this.shown + 1}&${search(this.search.value)}`);
        const cards = await Promise.all(jobs.slice(0, this.shown).map((job) => this.withThoseIn(job)));
        if (turn !== this.turn) return;
        this.show(cards.flat(), jobs.length > this.shown);
        if (jobs.every(({ status }) => ENDED.has(status))) return;
      } catch (problem) {
        if (!(problem instanceof Problem)) throw problem;
        this.line.textContent = problem.status ? problem.message : "";
        if (problem.status !== 0) return; // an away service is asked again
      }
      await pause(AGAIN);
      if (turn !== this.turn) return;
    }
  }

  /** A job, and behind an unfolded batch those in it. */
  async withThoseIn(job) {
    if (!this.unfolded.has(job.jobID)) return [job];
    const { jobs } = await get(`/v1/jobs?parent=${job.jobID}&limit=${job.children}`);
    return [job, ...[...jobs].sort((one, other) => one.place - other.place)];
  }

  fold(job) {
    if (!this.unfolded.delete(job.jobID)) this.unfolded.add(job.jobID);
    this.known = null;
    return this.refresh();
  }

  show(jobs, more) {
    byId("jobs-none").hidden = jobs.length > 0;
    byId("jobs-none").textContent = this.search.value ? "No such jobs." : "No jobs yet.";
    byId("jobs-rows").hidden = !jobs.length;
    byId("jobs-more").hidden = !more;
    const known = JSON.stringify(jobs);
    if (known === this.known) return;
    this.known = known;
    const { job: focus, action } = document.activeElement?.dataset ?? {};
    byId("jobs-rows").replaceChildren(...jobs.map((job) => this.card(job)));
    const left = focus ? [...document.querySelectorAll(`[data-job="${focus}"]`)] : [];
    (left.find((each) => each.dataset.action === action) ?? left[0])?.focus();
  }

  card(job) {
    const when = new Date(job.created).toLocaleString([], { dateStyle: "medium", timeStyle: "short" });
    const name = called(job);
    const about = `${job.processID}${name ? ` of ${name}` : ""}, ${when}`;
    const offered = (text, action) => button(text, action, { class: "small", "data-job": job.jobID, "data-action": text, "aria-label": `${text} ${about}` });
    const { status } = job;
    const alone = !job.children;
    const buttons = [
      !alone && offered(this.unfolded.has(job.jobID) ? "Hide jobs" : "Show jobs", () => this.fold(job)),
      !ENDED.has(status) && offered("Cancel", () => this.done(cancelled(job.jobID, this.line))),
      alone && status in OPENED && offered(OPENED[status], () => this.open(job)),
      alone && status === "successful" && COMPARED.has(job.processID) && offered("Compare", () => this.choose(job)),
      offered("Rename", () => this.done(renamed(job, this.line))),
    ].filter(Boolean);
    const what = job.children ? `${job.processID}, ${job.children} jobs` : job.processID;
    const facts = [what, stateOf(job), when].join(", ");
    return make(
      "li", { class: job.parentID ? "inner" : "" },
      ...label(job), ...headline(job.headline, job.jobID), make("p", { class: "hint" }, facts), make("div", { class: "buttons" }, ...buttons),
    );
  }

  /** The first of two jobs is remembered; the second one is compared with it. */
  async choose(job) {
    const { first } = this;
    const fits = first && first.jobID !== job.jobID && first.processID === job.processID;
    this.first = fits ? null : job;
    this.line.textContent = fits ? "" : `Choose another ${job.processID} job to compare this one with.`;
    if (fits) await saidIn(this.line, () => this.compare(first, job));
  }

  /** Look again once something was done. @param {Promise<void>} action */
  async done(action) {
    await action;
    await this.refresh();
  }
}
