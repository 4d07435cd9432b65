/** Jobs on the pair beside its analysis: a card for each process of the service that studies a case. */

import { card } from "./card.js";
import { byId } from "./elements.js";
import { optimizationOf, showOptimization } from "./optimize.js";
import { showReport } from "./report.js";

const IN_THE_PLANE = ["iso6336", "thin_slices", "plane_strain", "corrected_draft", "corrected", "corrected_fine"];
const QUICK_HELICAL = ["iso6336", "thin_slices", "3d_draft"];

/** The case for a study across the face, which a model of the plane does not know. */
function acrossTheFace(content) {
  const plane = /^plane/.test(content.accuracy?.model ?? "");
  return plane ? { ...content, accuracy: { ...content.accuracy, model: "3d" } } : content;
}

/**
 * What studies have beside their own fields, or make of what was typed, by process.
 * @type {Record<string, {fields?: import("./card.js").StudyField[], inputs: (found: any, values: any) => object}>}
 */
const OWN = {
  frontier: {
    fields: [{
      name: "reach", label: "Up to",
      choices: [["all", "fine 3-D finite elements (minutes)"], ["quick", "2-D finite elements; with a helix draft 3-D"]],
    }],
    inputs: (found, { reach }) => ({ case: found, ...(reach === "quick" ? { rungs: found.pair?.helix_angle_deg ? QUICK_HELICAL : IN_THE_PLANE } : {}) }),
  },
  sensitivity: { inputs: (found, values) => ({ case: acrossTheFace(found), ...values }) },
  optimize: {
    fields: [
      { name: "relief_um", label: "Most tip relief, µm", value: "40" },
      { name: "scatter_um", label: "Misalignment, standard deviation, µm", value: "10" },
      { name: "evaluations", label: "Designs tried, at most", value: "1000" },
    ],
    inputs: optimizationOf,
  },
};

/** The studies of a case among the processes of a service. */
export function studiesOf(processes) {
  return processes.map(cardOf).filter(({ action, subjects = [] }) => action && subjects.includes("case"));
}

/** What a process says for its card. */
function cardOf({ id, title, description, additionalParameters }) {
  const { action = [], subjects, fields = [{}] } = Object.fromEntries(additionalParameters.parameters.map(({ name, value }) => [name, value]));
  return { process: id, title, text: description, action: action[0], subjects, fields: [...Object.entries(fields[0]).map(fieldOf), ...(OWN[id]?.fields ?? [])] };
}

/** A field of a card, by the schema of the input. */
function fieldOf([name, schema]) {
  const kind = schema.anyOf?.find(({ type }) => type !== "null") ?? schema;
  const list = kind.type === "array";
  const value = list ? (schema.default ?? []).join(", ") : String(schema.default ?? "");
  return { name, label: schema.title, value, list, ...(kind.enum ? { choices: kind.enum.map((choice) => [choice, choice]) } : {}) };
}

/** Show a result of any kind but a table; `take` is given the flanks of an optimization. */
export async function showResult(target, reference, { take, signal }) {
  if (reference.kind === "optimization") await showOptimization(target, reference, { take, signal });
  else await showReport(target, reference, { signal });
}

/**
 * Offer the studies of the pair as typed.
 * @param {ReturnType<typeof studiesOf>} studies
 * @param {{design: import("./design.js").Design, slot: Function, show: Function}} page
 */
export function showStudies(studies, { design, slot, show }) {
  byId("study-list").replaceChildren(...studies.map((study) => {
    const { process } = study;
    const inputs = OWN[process]?.inputs ?? ((found, values) => ({ case: found, ...values }));
    return card(study, (parts) => slot(process, parts, show), (values) => ({ process, inputs: inputs(design.case, values) }));
  }));
}
