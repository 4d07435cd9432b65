// @ts-check
/** What a job is called in the gallery: its title, or what it is about; what sets it apart, its tags; and the search. */

import { patch, saidIn } from "./api.js";
import { make } from "./elements.js";
import { NONE, changeIn, unitOf, wordsIn, wordsOf } from "./field.js";

/** @typedef {{field: string, before: unknown, value: unknown}} Difference */
/** @typedef {{since: string | null, first: Difference[], number: number}} Differences */
/** @typedef {{jobID: string, title: string, subject: string, processID: string, tags: string[], differences: Differences | null}} Named */

const MOST = 3; // differences in a row

/** @param {Named} job @returns {string} */
export const called = (job) => job.title || job.subject;

/** The words for a job; below them what it is about, what sets it apart, and its tags. @param {Named} job @returns {HTMLElement[]} */
export function label(job) {
  const lines = [job.title && job.subject, apart(job.differences), job.tags.map((tag) => `#${tag}`).join(" ")];
  return [make("h3", {}, called(job) || job.processID), ...lines.filter(Boolean).map((text) => make("p", { class: "hint" }, text))];
}

/** The differences from the job before in a line; those from the defaults are what the job is about. @param {Differences | null} differences */
function apart(differences) {
  if (!differences?.since || !differences.number) return "";
  const shown = differences.first.map(change).filter(Boolean).slice(0, MOST); // not that a long text is another of its length
  const more = differences.number - shown.length;
  return [...shown, ...(more ? [`${more} more`] : [])].join("; ");
}

/** A difference in the words of the form; of what it has no field for, in those of its path. @param {Difference} difference */
function change({ field, before, value }) {
  const [root, ...path] = field.replaceAll(/\[(\d+)\]/g, (_, k) => ` ${Number(k) + 1}`).split(".");
  const words = root === "case" ? wordsIn(path) : [root, ...path].filter((name) => name !== "scene").map(wordsOf).join(" ").toLowerCase();
  const texts = [before, value].map((each) => (each === null ? NONE : [each].flat().join(", ")));
  return changeIn(words, unitOf(field), ...texts);
}

/** Ask for a title and give it to a job; what goes wrong is said in `line`. @param {Named} job @param {HTMLElement} line */
export async function renamed(job, line) {
  const title = prompt("Name of the job", called(job));
  if (title !== null) await saidIn(line, () => patch(`/v1/jobs/${job.jobID}`, { title }));
}

/** Parameters of the list for a search: words of titles, and tags behind a #. @param {string} text @returns {string} */
export function search(text) {
  const words = text.split(/\s+/).filter(Boolean);
  const wanted = new URLSearchParams({ title: words.filter((word) => !word.startsWith("#")).join(" ") });
  for (const word of words) if (word.startsWith("#") && word.length > 1) wanted.append("tag", word.slice(1));
  return wanted.toString();
}
