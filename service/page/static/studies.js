/** Jobs on the pair beside its analysis: flank pressure, effects, accuracy study, sensitivity, search of flanks, tolerances. */

import { card } from "./card.js";
import { byId } from "./elements.js";
import { optimisationOf, showOptimisation } from "./optimise.js";
import { showReport } from "./report.js";

const IN_THE_PLANE = ["iso6336", "thin_slices", "plane_strain", "corrected_draft", "corrected", "corrected_fine"];
const QUICK_HELICAL = ["iso6336", "thin_slices", "3d_draft"];

/** The case for a study across the face, which a model of the plane does not know. */
function acrossTheFace(content) {
  const plane = /^plane/.test(content.accuracy?.model ?? "");
  return plane ? { ...content, accuracy: { ...content.accuracy, model: "3d" } } : content;
}

export const STUDIES = [
  {
    process: "flank", title: "Flank pressure", action: "Compute flank pressure",
    text: "Contact pressure, line load and gap on the flanks over a mesh cycle, at one load and misalignment.",
    fields: [
      { name: "torque_n_m", label: "Torque on the pinion, N m" }, { name: "misalignment_um", label: "Misalignment, µm" },
    ],
    inputs: (found, values) => ({ case: found, ...values }),
  },
  {
    process: "ablate", title: "Effects", action: "Toggle every effect",
    text: "What each effect changes, toggled by itself, beside what the ledger estimated, and what it costs.",
    inputs: (found) => ({ case: found }),
  },
  {
    process: "frontier", title: "Accuracy frontier", action: "Run the accuracy study",
    text: "Error against time of every way to compute this case, from closed forms to the finest mesh.",
    fields: [{
      name: "reach", label: "Up to",
      choices: [["all", "fine 3-D finite elements (minutes)"], ["quick", "2-D finite elements; with a helix draft 3-D"]],
    }],
    inputs: (found, { reach }) => ({ case: found, ...(reach === "quick" ? { rungs: found.pair?.helix_angle_deg ? QUICK_HELICAL : IN_THE_PLANE } : {}) }),
  },
  {
    process: "sensitivity", title: "Sensitivity", action: "Study the sensitivity",
    text: "Peak to peak over misalignment and center distance, without and with corner contact, in three dimensions.",
    fields: [
      { name: "misalignment_um", label: "Misalignments, µm", value: "0, 15, 30, 45, 60", list: true },
      { name: "center_distance_change_percent", label: "Changes of the center distance, %", value: "-0.2, -0.1, 0, 0.1, 0.2", list: true },
    ],
    inputs: (found, values) => ({ case: acrossTheFace(found), ...values }),
  },
  {
    process: "optimise", title: "Optimise the flanks", action: "Search better flanks",
    text: "Tip relief of both gears (and crowning, in three dimensions) of least expected peak to peak over the torques of the case.",
    fields: [
      { name: "relief_um", label: "Most tip relief, µm", value: "40" },
      { name: "scatter_um", label: "Misalignment, standard deviation, µm", value: "10" },
      { name: "evaluations", label: "Designs tried, at most", value: "1000" },
    ],
    inputs: optimisationOf,
  },
  {
    process: "scatter", title: "Tolerances", action: "Draw pairs within tolerances",
    text: "Distribution of peak to peak over pairs drawn within the flank tolerances of a class of ISO 1328-1, and which deviation counts.",
    fields: [
      { name: "tolerance_class", label: "Class", value: "6" }, { name: "samples", label: "Pairs", value: "500" },
    ],
    inputs: (found, values) => ({ case: found, ...values }),
  },
];

/** Show a result of any kind but a table; `take` is given the flanks of an optimisation. */
export async function showResult(target, reference, { take, signal }) {
  if (reference.kind === "optimisation") await showOptimisation(target, reference, { take, signal });
  else await showReport(target, reference, { signal });
}

/**
 * Offer the studies of the pair as typed.
 * @param {{design: import("./design.js").Design, offered: Set<string>, slot: Function, show: Function}} page
 */
export function showStudies({ design, offered, slot, show }) {
  byId("study-list").replaceChildren(...STUDIES.filter(({ process }) => offered.has(process)).map((study) => {
    const { process, inputs } = study;
    return card(study, (parts) => slot(process, parts, show), (values) => ({ process, inputs: inputs(design.case, values) }));
  }));
}
