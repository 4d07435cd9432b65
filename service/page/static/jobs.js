/** The jobs of the service, newest first: how far they are, reopened or cancelled. */

import { Problem, get, pause } from "./api.js";
import { byId, duration, make } from "./elements.js";
import { ENDED, WORDS, cancelled } from "./job.js";
import { called, label, renamed, search } from "./job_label.js";

const AT_ONCE = 10;
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
        const { jobs } = await get(`/v1/jobs?limit=${this.shown + 1}&${search(this.search.value)}`);
        if (turn !== this.turn) return;
        this.show(jobs);
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

  show(jobs) {
    byId("jobs-none").hidden = jobs.length > 0;
    byId("jobs-none").textContent = this.search.value ? "No such jobs." : "No jobs yet.";
    byId("jobs-table").hidden = !jobs.length;
    byId("jobs-more").hidden = jobs.length <= this.shown;
    const known = JSON.stringify(jobs);
    if (known === this.known) return;
    this.known = known;
    const focus = document.activeElement?.dataset?.job;
    byId("jobs-rows").replaceChildren(...jobs.slice(0, this.shown).map((job) => this.row(job)));
    if (focus) document.querySelector(`[data-job="${focus}"]`)?.focus();
  }

  row(job) {
    const when = new Date(job.created).toLocaleString([], { dateStyle: "medium", timeStyle: "short" });
    const name = called(job);
    const about = `${job.processID}${name ? ` of ${name}` : ""}, ${when}`;
    const button = (text, action) => make(
      "button", { type: "button", class: "small", "data-job": job.jobID, "aria-label": `${text} ${about}`, onclick: action }, text,
    );
    const actions = {
      successful: () => button("Open", () => this.open(job)),
      failed: () => button("Why", () => this.open(job)),
    };
    const both = () => (job.status === "successful" && COMPARED.has(job.processID) ? button("Compare", () => this.choose(job)) : "");
    const action = ENDED.has(job.status) ? actions[job.status]?.() : button("Cancel", () => this.cancel(job));
    const rename = button("Rename", () => this.rename(job));
    const cells = [state(job), when, spent(job)].map((text) => make("td", {}, text));
    return make(
      "tr", {}, make("th", { scope: "row" }, job.processID), make("td", {}, action ?? "", " ", both(), " ", rename), label(job), ...cells,
    );
  }

  /** The first of two jobs is remembered; the second one is compared with it. */
  async choose(job) {
    const { first } = this;
    const fits = first && first.jobID !== job.jobID && first.processID === job.processID;
    this.first = fits ? null : job;
    this.line.textContent = fits ? "" : `Choose another ${job.processID} job to compare this one with.`;
    if (!fits) return;
    try {
      await this.compare(first, job);
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      this.line.textContent = problem.message;
    }
  }

  async rename(job) {
    await renamed(job, this.line);
    await this.refresh();
  }

  async cancel(job) {
    await cancelled(job.jobID, this.line);
    await this.refresh();
  }
}

function state(job) {
  return job.status === "running" ? `runs, ${Math.round(job.progress ?? 0)} %` : WORDS[job.status];
}

function spent(job) {
  if (!job.started || !job.finished) return "";
  return duration((new Date(job.finished) - new Date(job.started)) / 1000);
}
