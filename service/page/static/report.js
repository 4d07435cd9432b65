/** A stored result as the service's report describes it: main results, figures, tables, files. */

import { file, get, patiently, saidIn } from "./api.js";
import { button, dataTable, figures, folded, make, save } from "./elements.js";
import { figureBlock, painted, plot } from "./plots.js";
import { soundBlock } from "./sound.js";

/** What a report is of, as one sentence. @param {{title: string, lead: string}} report */
export const leadOf = ({ title, lead }) => (lead ? `${title}: ${lead.replace(/\.$/, "")}.` : `${title}.`);

/**
 * Show the report of a result.
 * @param {HTMLElement} target
 * @param {{href: string, type: string, hash: string, against?: string}} result reference to it, and the hash of another one to compare it with
 * @param {{making?: boolean, signal: AbortSignal, place?: (key: string) => HTMLElement | null, alarms?: HTMLElement}} options with the tables that say how it was made; given up when it is left; where a figure stands, and the warnings, if not in `target`
 */
export async function showReport(target, result, { making = false, signal, place = () => null, alarms: warnings }) {
  target.setAttribute("aria-busy", "true");
  const figuresAt = `${result.href}/figures${result.against ? `?against=${result.against}` : ""}`;
  const report = await patiently(() => get(figuresAt)).catch((problem) => {
    target.setAttribute("aria-busy", "false");
    throw problem;
  });
  if (signal.aborted) return null;
  const head = make("dl", { class: "headline" });
  figures(head, report.headlines.map(({ name, value, remark }) => [name, value, remark]));
  const alarms = report.alarms.map((text) => make("p", { class: "alarm", role: "alert" }, text));
  const drawn = [];
  const shown = report.sections.filter((one) => making || one.part === "results" || one.figures.length);
  const sections = shown.map((one) => sectionBlock(one, { drawn, result, place }));
  target.replaceChildren(
    make("p", { class: "lead" }, leadOf(report)), ...(warnings ? [] : alarms), head, files(result, figuresAt), ...sections,
  );
  warnings?.replaceChildren(...alarms);
  for (const [node, figure] of drawn) {
    await painted(); // between two plots the page answers
    if (signal.aborted) return null;
    await plot(node, figure);
  }
  target.setAttribute("aria-busy", "false");
  return report;
}

function sectionBlock(section, { drawn, result, place }) {
  const parts = section.figures.flatMap((figure) => {
    const { block, node } = figureBlock(figure);
    if (figure.sound) block.append(soundBlock(node, figure, result));
    drawn.push([node, figure.plot]);
    const elsewhere = place(figure.key);
    elsewhere?.append(block);
    return elsewhere ? [] : [block];
  });
  const tables = section.tables.map((table) => dataTable(table));
  const more = section.folded.map((table) => folded(table.caption, dataTable(table)));
  const text = section.text ? make("p", {}, section.text) : null;
  if (!parts.length && !tables.length && !more.length && !text) return "";
  if (!parts.length && section.part !== "results") return folded(section.title, ...(text ? [text] : []), ...tables, ...more);
  return make("div", {}, make("h3", {}, section.title), text ?? "", ...parts, ...tables, ...more);
}

/** Buttons for the files of a result; a comparison has its figures only. */
function files(result, figuresAt) {
  const name = `lineofaction_${result.hash.slice(0, 12)}`;
  const line = make("span", { class: "fault", role: "status" });
  const row = make("div", { class: "row files" }, make("span", { class: "hint" }, "Save"));
  const offer = (text, action) => row.append(button(text, () => saidIn(line, action)));
  if (!result.against) offer("netCDF", async () => save(await file(result.href, result.type), `${name}.nc`));
  if (!result.against) offer("JSON", async () => save(await file(result.href, "application/json"), `${name}.json`));
  offer("Report to print", async () => save(await file(figuresAt, "text/html"), `${name}.html`));
  offer("Figures as JSON", async () => save(await file(figuresAt, "application/json"), `${name}_figures.json`));
  row.append(line);
  return row;
}
