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

async function asked(path, options = {}) {
  let response;
  try {
    response = await fetch(path, { ...options, headers: { ...options.headers, ...keyHeader() } });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Problem({ title: "No answer", detail: "The service does not answer. Is it still running?", status: 0 });
  }
  if (response.status !== 401) return response;
  const refused = await response.clone().json().catch(() => ({ detail: "" }));
  return (await askForKey(refused.detail)) ? asked(path, options) : response;
}

export async function get(path) {
  return (await answer(await asked(path))).json();
}

export async function post(path, body, signal) {
  const headers = { "Content-Type": "application/json" };
  return (await answer(await asked(path, { method: "POST", headers, body: JSON.stringify(body), signal }))).json();
}

export async function dismiss(path) {
  return (await answer(await asked(path, { method: "DELETE" }))).json();
}

export async function file(path, type) {
  return (await answer(await asked(path, { headers: { Accept: type } }))).blob();
}

export const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
