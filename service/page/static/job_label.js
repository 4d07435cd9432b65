// @ts-check
/** What a job is called in the list: its title and tags, or what it is about; and the search for them. */

import { Problem, patch } from "./api.js";
import { make } from "./elements.js";
import { nameOf } from "./job_names.js";

/** @typedef {{jobID: string, title: string, tags: string[]}} Named */

/** @param {Named} job @returns {string} */
export const called = (job) => job.title || nameOf(job.jobID);

/** The words for a job, its tags below. @param {Named} job */
export function label(job) {
  const tags = job.tags.length ? make("span", { class: "hint" }, job.tags.map((tag) => `#${tag}`).join(" ")) : null;
  return make("td", { class: "called" }, called(job), tags);
}

/** Ask for a title and give it to a job; what goes wrong is said in `line`. @param {Named} job @param {HTMLElement} line */
export async function renamed(job, line) {
  const title = prompt("Name of the job", called(job));
  if (title === null) return;
  try {
    await patch(`/v1/jobs/${job.jobID}`, { title });
  } catch (problem) {
    if (!(problem instanceof Problem)) throw problem;
    line.textContent = problem.message;
  }
}

/** Parameters of the list for a search: words of titles, and tags behind a #. @param {string} text @returns {string} */
export function search(text) {
  const words = text.split(/\s+/).filter(Boolean);
  const wanted = new URLSearchParams({ title: words.filter((word) => !word.startsWith("#")).join(" ") });
  for (const word of words) if (word.startsWith("#") && word.length > 1) wanted.append("tag", word.slice(1));
  return wanted.toString();
}
