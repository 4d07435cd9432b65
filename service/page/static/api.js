/** Requests to the service: JSON in and out, every refusal as a Problem. */

import { askForKey, keyHeader } from "./key.js";

export class Problem extends Error {
  /** @param {object} facts problem details (RFC 9457) */
  constructor(facts) {
    super(facts.detail || facts.title);
    this.facts = facts;
    this.errors = facts.errors || [];
    this.status = facts.status;
    this.type = facts.type || "";
    this.retryAfter = Number(facts.retryAfter) || 0;
  }
}

async function answer(response) {
  if (response.ok) return response;
  let facts = { title: response.statusText, detail: response.statusText, status: response.status };
  try {
    facts = await response.json();
  } catch {
    // a proxy in between answers with something else
  }
  throw new Problem({ ...facts, retryAfter: response.headers.get("Retry-After") });
}

let answers = true;

/** Tell the page when the service stops answering, and when it does again. */
function heard(now) {
  if (now === answers) return;
  answers = now;
  document.dispatchEvent(new Event(now ? "service-back" : "service-away"));
}

const unanswered = () => new Problem({ title: "No answer", detail: "The service does not answer. Is it still running?", status: 0 });

/** What an answer holds; a request may be given up, or its connection end, while it is read. */
async function read(response) {
  const text = await response.text().catch(() => { throw unanswered(); });
  return JSON.parse(text);
}

async function asked(path, options = {}) {
  let response;
  const key = keyHeader();
  try {
    response = await fetch(path, { ...options, headers: { ...options.headers, ...key } });
  } catch {
    if (!options.signal?.aborted) heard(false);
    throw unanswered();
  }
  heard(true);
  if (response.status !== 401) return response;
  if (key.Authorization !== keyHeader().Authorization) return asked(path, options); // another key was given meanwhile
  const refused = await response.clone().json().catch(() => ({ detail: "" }));
  return (await askForKey(refused.detail)) ? asked(path, options) : response;
}

export async function get(path) {
  return read(await answer(await asked(path)));
}

/** @returns {(path: string, body: object, signal?: AbortSignal) => Promise<any>} a request with a body, which the signal gives up */
const sending = (method) => async (path, body, signal) => read(await answer(await asked(path, {
  method, headers: { "Content-Type": "application/json" }, body: JSON.stringify(body), signal,
})));

export const post = sending("POST");
export const patch = sending("PATCH");

/**
 * Ask about what is being typed: `outline`, `to-toml`, `as-made`, `plan`, `HASH/ste`. What is wrong with it is an answer of the service,
 * no refusal that the browser logs; here it is thrown as a Problem like all others.
 */
export async function ask(question, body, signal) {
  const found = await post(`/v1/drafts/${question}`, body, signal);
  if (found.faults) throw new Problem({ detail: found.detail, errors: found.faults });
  return found;
}

export async function dismiss(path) {
  return read(await answer(await asked(path, { method: "DELETE" })));
}

export async function file(path, type) {
  return (await answer(await asked(path, { headers: { Accept: type } }))).blob();
}

/** Do something that the service may refuse; `say` is given the Problem then. */
export async function guarded(action, say) {
  try {
    return await action();
  } catch (problem) {
    if (!(problem instanceof Problem)) throw problem;
    return say(problem);
  }
}

/** Do something that the service may refuse, which is said in a line then. */
export function saidIn(line, action) {
  line.textContent = "";
  return guarded(action, (problem) => { line.textContent = problem.message; });
}

export const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

const NOT_NOW = new Set([0, 502, 503, 504]);

/** Ask until the service answers: it is away, or busy for a moment. `waits` is told why, null when it is over. */
export async function patiently(action, waits = () => {}) {
  for (;;) {
    try {
      const found = await action();
      waits(null);
      return found;
    } catch (problem) {
      if (!(problem instanceof Problem) || !NOT_NOW.has(problem.status)) throw problem;
      waits(problem);
      await pause(1000 * Math.max(problem.retryAfter, 2));
    }
  }
}
