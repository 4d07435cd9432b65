/** A job: submitted, watched with its stage and the time that remains, cancelled on request. */

import { Problem, dismiss, get, patiently, pause, post, saidIn } from "./api.js";
import { button, duration, make } from "./elements.js";

export const ENDED = new Set(["successful", "failed", "dismissed"]);
const FIRST_LOOK = 150;
const AGAIN = "It is asked for again until there is an answer.";
const LONGEST_LOOK = 1000;

/**
 * Submit a job, or take the equal one that is under way or done: so one whose answer was lost with the connection is submitted again.
 * @param {HTMLElement} target where it is said that the service is asked in vain
 * @param {string} process
 * @param {{inputs: object, title: string}} order what it is to compute, and what it is called
 */
export async function submitted(target, process, order) {
  const status = await patiently(() => post(`/v1/processes/${process}/execution`, { ...order, reuse: true }), (problem) => {
    target.replaceChildren(...(problem ? [make("p", { class: "hint", role: "status" }, `${problem.message} ${AGAIN}`)] : []));
  });
  document.dispatchEvent(new Event("jobs-changed"));
  return status;
}

/**
 * Follow a job to its end and show how far it is.
 * @param {HTMLElement} target where progress is shown
 * @param {string} id
 * @param {{expected?: number, signal: AbortSignal}} options seconds that the plan predicts; given up when the job is left
 * @returns {Promise<{kind: string, href: string, type: string, hash: string}>} reference to the result
 */
export async function followed(target, id, { expected, signal }) {
  const ended = await watched(target, id, expected, signal);
  if (signal.aborted) return null;
  document.dispatchEvent(new Event("jobs-changed"));
  if (ended.status === "dismissed") throw new Problem({ title: "Cancelled", detail: "The job was cancelled.", status: 410 });
  return referenceOf(id);
}

/** What a job computes: its process, and its inputs as they were submitted. @param {string} job */
export const orderOf = (job) => patiently(() => get(`/v1/jobs/${job}/inputs`));

/** Where a job's result is, whatever form it was submitted with. */
export async function referenceOf(job) {
  const results = await patiently(() => get(`/v1/jobs/${job}/results?response=document&transmissionMode=reference`));
  const [[kind, reference]] = Object.entries(results);
  return { kind, ...reference };
}

/** Look at a job until it has ended or is left; while the service is away, wait for it. */
async function watched(target, id, expected, signal) {
  let card = null;
  let wait = FIRST_LOOK;
  for (;;) {
    const now = await patiently(() => get(`/v1/jobs/${id}`), (problem) => card?.waits(problem));
    if (signal.aborted) return now;
    card ??= new JobCard(target, now, expected);
    card.show(now);
    if (ENDED.has(now.status)) return now;
    await pause(wait);
    wait = Math.min(1.3 * wait, LONGEST_LOOK);
    if (signal.aborted) return now;
  }
}

const WORDS = { accepted: "waits for its turn", running: "runs", successful: "done", failed: "failed", dismissed: "cancelled" };

/** The state of a job in words, behind how many others it waits, and how far it is. */
export function stateOf(job, atOnce = "") {
  const behind = job.ahead ? ` behind ${job.ahead} job${job.ahead === 1 ? "" : "s"}` : "";
  return `${WORDS[job.status]}${behind}${job.status === "running" ? `, ${Math.round(job.progress ?? 0)} %` : spent(job, atOnce)}`;
}

/** How long a job took that has ended. */
function spent({ started, finished }, atOnce = "") {
  const seconds = (new Date(finished) - new Date(started)) / 1000;
  return !started || !finished ? "" : seconds < 0.5 ? atOnce : ` after ${duration(seconds)}`;
}

class JobCard {
  constructor(target, status, expected) {
    const process = status.processID;
    this.process = process;
    this.expected = expected;
    this.said = "";
    this.bar = make("progress", { max: "100", "aria-label": `Progress of ${process}` });
    this.line = make("p", {});
    this.spoken = make("p", { class: "hint", role: "status" });
    this.cancel = button(`Cancel ${process}`, () => cancelled(status.jobID, this.spoken), { class: "small" });
    target.replaceChildren(make("div", { class: "job" }, this.line, this.bar, this.spoken, this.cancel));
  }

  show(now) {
    const ended = ENDED.has(now.status);
    this.bar.value = now.status === "successful" ? 100 : now.progress ?? 0;
    this.cancel.hidden = ended;
    this.bar.hidden = ended;
    this.line.textContent = `${this.process} ${stateOf(now, " (from the store)")}`;
    const remaining = this.remaining(now);
    const text = ended ? "" : [now.stage ? `stage: ${now.stage}` : "", remaining].filter(Boolean).join("; ");
    if (text !== this.said) this.spoken.textContent = text; // a screen reader hears changes only
    this.said = text;
  }

  /** Say that the service is asked in vain; null: no longer. */
  waits(problem) {
    if (problem) this.spoken.textContent = `${problem.message} ${AGAIN}`;
    else if (this.spoken.textContent !== this.said) this.spoken.textContent = this.said;
  }

  /** Seconds that remain by the service, which says none as long as it does not know its pace; until then the plan. */
  remaining(now) {
    if (now.status !== "running") return "";
    if (Number.isFinite(now.remaining_s)) return `about ${duration(now.remaining_s)} remain`;
    return this.expected ? `planned: about ${duration(this.expected)}` : "";
  }
}

/** Dismiss a job; what goes wrong is said in `line`. */
export const cancelled = (id, line) => saidIn(line, () => dismiss(`/v1/jobs/${id}`));

/** What is wrong, fault by fault. @param {Problem} problem */
export function faultsOf(problem) {
  const faults = problem.errors.map((fault) => make("li", {}, `${fault.field} must be ${fault.bound}. ${fault.suggestion || ""}`));
  return faults.length ? make("ul", {}, ...faults) : make("p", {}, problem.message);
}

/** Say why there is no result. */
export function showFailure(target, problem) {
  target.replaceChildren(make("div", { role: "alert" }, make("strong", {}, problem.facts.title || "It failed"), faultsOf(problem)));
}
