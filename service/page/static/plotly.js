// @ts-check
/** plotly.js, fetched when something is drawn by it for the first time: the page is read and typed into without it. */

import { Problem } from "./api.js";

const SCRIPT = "/page/plotly.min.js";

/** @type {Promise<any> | null} */
let loading = null;

/** The library; what could not be fetched is fetched again by the next plot. */
export function plotly() {
  loading ??= fetched().catch((reason) => {
    loading = null;
    throw reason;
  });
  return loading;
}

const AWAY = { title: "No answer", detail: "The service does not send what plots are drawn with.", status: 0 };

/** Fetch the library beside what it will show; it is not run before a plot is drawn. */
export function fetchPlotly() {
  if (loading) return;
  const link = document.createElement("link");
  Object.assign(link, { rel: "preload", as: "script", href: SCRIPT });
  document.head.append(link);
}

/** @returns {Promise<any>} */
function fetched() {
  return new Promise((done, failed) => {
    const script = document.createElement("script");
    script.src = SCRIPT;
    script.addEventListener("load", () => done(/** @type {any} */ (window).Plotly));
    script.addEventListener("error", () => failed(new Problem(AWAY)));
    document.head.append(script);
  });
}
