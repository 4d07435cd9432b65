// @ts-check
/** The result at a glance, at the top of the page: main figures and transmission error, from the report. */

import { byId, figures } from "./elements.js";
import { layout } from "./live_figures.js";
import { fetchPlotly } from "./plotly.js";
import { painted, plot } from "./plots.js";

const FIGURE = "ste";
const PANEL = "y"; // the ripple; its Harris map stays with the results
const HEIGHT = 270;
const WAITS = "The first example is computed now, once for this service: its result appears here.";

export class Glance {
  /** Say that there will be one, and keep its place: what is typed meanwhile does not move. */
  waits() {
    byId("glance-words").textContent = WAITS;
    byId("glance").hidden = false;
    fetchPlotly();
  }

  /** Show the report of a table. @param {any} report */
  async show(report) {
    byId("glance-words").textContent = `Result, as analyzed: ${report.title}, ${report.lead}.`;
    figures(byId("glance-figures"), report.headlines.map(({ name, value, remark }) => [name, value, remark]));
    byId("glance").hidden = false;
    const figure = report.sections.flatMap((section) => section.figures).find(({ key }) => key === FIGURE);
    const node = byId("glance-plot");
    node.setAttribute("aria-label", figure.alternative);
    await painted(); // numbers first: the library of the plots takes longer than they do
    await plot(node, ripple(figure.plot));
  }

  leave() {
    byId("glance").hidden = true;
    byId("glance-words").textContent = "";
  }
}

/** The first panel of the figure of the report, named by a legend. */
function ripple({ data, layout: { yaxis } }) {
  const made = layout(HEIGHT, "position, base pitches", yaxis.title.text);
  made.yaxis.range = yaxis.range;
  const traces = data.filter((trace) => trace.yaxis === PANEL).map((trace) => ({ ...trace, showlegend: Boolean(trace.name) }));
  return { data: traces, layout: made };
}
