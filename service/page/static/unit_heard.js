// @ts-check
/** Which mesh of a gear unit makes what is complained of: by the teeth along the way from the shaft whose speed is stated. */

import { byId, number, signed } from "./elements.js";
import { heardIn } from "./complaint.js";

/** @typedef {{name: string, frequency: number, harmonic: number | null, off: number}} Heard frequency of the mesh, Hz; the nearest harmonic and how far it is off, % */

/**
 * What each mesh of a unit makes at a speed of the driving shaft of its first mesh; meshes that are not reached are left out.
 * @param {any} scene @param {any} complaint of the first mesh's pair @returns {Heard[]}
 */
export function meshesHeard({ meshes = [], gears = [] }, complaint) {
  const shaftOf = new Map(gears.map(({ name, shaft }) => [name, shaft]));
  const cases = meshes.filter((mesh) => mesh.case);
  if (!cases.length) return [];
  const { mesh: first, within } = heardIn({ complaint, pair: cases[0].case.pair });
  const speeds = new Map([[shaftOf.get(cases[0].driver), first / cases[0].case.pair.pinion.teeth]]); // revolutions per second
  const reached = new Map();
  for (let k = 0; k < cases.length; k += 1) {
    for (const { name, driver, driven, case: { pair } } of cases) {
      const ends = [[shaftOf.get(driver), pair.pinion.teeth], [shaftOf.get(driven), pair.wheel.teeth]];
      const known = ends.find(([shaft]) => speeds.has(shaft));
      if (!known) continue;
      const frequency = speeds.get(known[0]) * known[1];
      for (const [shaft, teeth] of ends) if (!speeds.has(shaft)) speeds.set(shaft, frequency / teeth);
      reached.set(name, frequency);
    }
  }
  return [...reached].map(([name, frequency]) => {
    const order = complaint.frequency_hz / frequency;
    const near = Math.max(Math.round(order), 1);
    const off = 100 * (near / order - 1);
    return { name, frequency, harmonic: Math.abs(off) <= within ? near : null, off };
  });
}

/** @param {Heard} heard */
const words = ({ name, frequency, harmonic, off }) => (
  `${name} at ${number(frequency)} Hz: ${harmonic ? `harmonic ${harmonic}, off by ${signed(off, 2)} %` : "no harmonic near"}`);

/** The line under the tree of a unit. */
export class UnitHeard {
  /** @param {import("./design.js").Design} design @param {import("./unit.js").OpenedUnit} unit */
  constructor(design, unit) {
    Object.assign(this, { design, unit });
    design.watch(() => this.follow());
  }

  follow() {
    const { complaint = {} } = this.design.case;
    const { scene } = (!this.unit.place.hidden && this.unit.unit) || {};
    const heard = scene && complaint.frequency_hz ? meshesHeard(scene, complaint).filter(({ frequency }) => frequency > 0) : [];
    const first = heard.length ? `At ${number(complaint.frequency_hz)} Hz, speed of the first mesh: ` : "";
    byId("unit-heard").textContent = first && `${first}${heard.map(words).join("; ")}.`;
  }
}
