// @ts-check
/** The result at a glance, at the top of the page: its main figures and its curve at the middle torque. */

import { Problem, post } from "./api.js";
import { byId, figures, number } from "./elements.js";
import { steFigure } from "./live_figures.js";
import { mainFigures } from "./live_numbers.js";
import { plot } from "./plots.js";

const HEIGHT = 230;
const NOTHING = { harmonics_um: [], flanks: {} };
const WAITS = "The first example is computed now, once for this service: its result appears here.";

export class Glance {
  /** @param {string} caller by whom the curve is asked for */
  constructor(caller) {
    this.caller = `${caller}-glance`;
    this.key = null;
  }

  /** Say that there will be one, and keep its place: what is typed meanwhile does not move. */
  waits() {
    byId("glance-words").textContent = WAITS;
    byId("glance").hidden = false;
  }

  /**
   * Show a result, or none. A pair whose compliance is not here has its report only.
   * @param {{key: string, case: any, torque: number} | null} known
   */
  async show(known) {
    this.key = known?.key ?? null;
    if (!known) return this.leave();
    try {
      const body = { torque_n_m: [known.torque], flanks: true, caller: this.caller };
      const [curve] = (await post(`/v1/databases/${known.key}/ste`, body)).curves;
      if (this.key === known.key) await this.draw(known.case.pair, known.torque, curve);
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      this.leave();
    }
  }

  leave() {
    byId("glance").hidden = true;
    byId("glance-words").textContent = "";
  }

  async draw({ pinion, wheel, normal_module_mm: module }, torque, curve) {
    const pair = `${pinion.teeth}/${wheel.teeth}, module ${module} mm, at ${number(torque, 3)} N m`;
    byId("glance-words").textContent = `Result for ${pair}, as analyzed.`;
    figures(byId("glance-figures"), mainFigures(curve, NOTHING));
    byId("glance").hidden = false;
    const node = byId("glance-plot");
    node.setAttribute("aria-label", `Transmission error of ${pair}: peak to peak ${number(curve.peak_to_peak_um, 3)} µm.`);
    const { data, layout } = steFigure([{ name: "as analyzed", curve, color: "#0072B2", width: 2.4, dash: "solid" }]);
    const title = { ...layout.yaxis.title, text: "TE less its mean, µm" };
    await plot(node, { data, layout: { ...layout, height: HEIGHT, showlegend: false, yaxis: { ...layout.yaxis, title }, margin: { ...layout.margin, t: 8 } } });
  }
}
