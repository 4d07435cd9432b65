// @ts-check
/** Which mesh of a gear unit makes what is complained of: by the teeth along the way from the shaft whose speed is stated. */

import { byId, number, signed } from "./elements.js";
import { heardIn, orderWords, WITHIN } from "./complaint.js";

/** @typedef {{name: string, frequency: number, shaft: string, order: number, harmonic: number | null, off: number}} Heard frequency of the mesh, Hz; the shaft of its driver and the order of it; the nearest harmonic and how far it is off, % */

/**
 * What each mesh of a unit makes at a speed of the driving shaft of one mesh; meshes that are not reached are left out.
 * @param {any} scene @param {any} complaint of that mesh's pair @param {string} [from] its name; left out: the first @returns {Heard[]}
 */
export function meshesHeard({ meshes = [], gears = [] }, complaint, from) {
  const shaftOf = new Map(gears.map(({ name, shaft }) => [name, shaft]));
  const cases = meshes.filter((mesh) => mesh.case);
  if (!cases.length) return [];
  const start = cases.find(({ name }) => name === from) ?? cases[0];
  const { mesh: first, within } = heardIn({ complaint, pair: start.case.pair });
  const speeds = new Map([[shaftOf.get(start.driver), first / start.case.pair.pinion.teeth]]); // revolutions per second
  const reached = new Map();
  for (let k = 0; k < cases.length; k += 1) {
    for (const { name, driver, driven, case: { pair } } of cases) {
      const ends = [[shaftOf.get(driver), pair.pinion.teeth], [shaftOf.get(driven), pair.wheel.teeth]];
      const known = ends.find(([shaft]) => speeds.has(shaft));
      if (!known) continue;
      const frequency = speeds.get(known[0]) * known[1];
      for (const [shaft, teeth] of ends) if (!speeds.has(shaft)) speeds.set(shaft, frequency / teeth);
      const shaft = shaftOf.get(driver);
      reached.set(name, { frequency, shaft, order: complaint.frequency_hz / speeds.get(shaft) });
    }
  }
  return [...reached].map(([name, mesh]) => {
    const multiple = complaint.frequency_hz / mesh.frequency;
    const near = Math.max(Math.round(multiple), 1);
    const off = 100 * (near / multiple - 1);
    return { name, ...mesh, harmonic: Math.abs(off) <= within ? near : null, off };
  });
}

/** @param {Heard} heard */
const words = ({ name, frequency, harmonic, off }) => (
  `${name} at ${number(frequency)} Hz: ${harmonic ? `harmonic ${harmonic}, off by ${signed(off, 2)} %` : "no harmonic near"}`);

/** The answer of a unit in one sentence: the lowest harmonic first. @param {Heard[]} heard @param {number} within */
export function answerOf(heard, within) {
  const near = heard.filter(({ harmonic }) => harmonic).sort((one, other) => one.harmonic - other.harmonic);
  if (!near.length) return `no harmonic of any mesh within ${within} %`;
  const [{ name, shaft, order, harmonic, off }, ...others] = near;
  const or = others.map((other) => `${other.harmonic} of ${other.name}`).join(", ");
  return `${orderWords(order, shaft)}, harmonic ${harmonic} of ${name} (${signed(off, 2)} %)${or && `, or ${or}`}`;
}

/** A complaint as another mesh of a unit has it, by the teeth on the way: its speed and its torque. @param {import("./unit.js").OpenedUnit} unit @param {any} mesh @returns {any} undefined: there is none */
export function translated(unit, mesh) {
  const { complaint } = unit.design.case;
  if (!complaint) return undefined;
  const from = unit.openedMesh.name;
  const heard = complaint.speed_rpm ? meshesHeard(unit.unit.scene ?? {}, complaint, from) : [];
  const [own, other] = [from, mesh.name].map((name) => heard.find((each) => each.name === name));
  if (!own || !other || from === mesh.name) return complaint;
  const rpm = (60 * other.frequency) / mesh.case.pair.pinion.teeth;
  const torque = complaint.torque_n_m && { torque_n_m: Number((complaint.torque_n_m * (complaint.speed_rpm / rpm)).toPrecision(6)) };
  return { ...complaint, speed_rpm: Number(rpm.toPrecision(9)), ...torque };
}

/** The line under the tree of a unit, and its answer in the bar. */
export class UnitHeard {
  /** @param {import("./design.js").Design} design @param {import("./unit.js").OpenedUnit} unit @param {import("./complaint.js").Complaint} bar */
  constructor(design, unit, bar) {
    Object.assign(this, { design, unit, bar });
    design.watch(() => this.follow());
    document.addEventListener("subject", () => this.follow()); // a unit that is read after its pair
  }

  follow() {
    const { complaint = {} } = this.design.case;
    const { scene } = (!this.unit.place.hidden && this.unit.unit) || {};
    const heard = scene && complaint.frequency_hz ? meshesHeard(scene, complaint, this.unit.openedMesh.name).filter(({ frequency }) => frequency > 0) : [];
    const first = heard.length ? `At ${number(complaint.frequency_hz)} Hz: ` : "";
    if (heard.length) this.bar.say(answerOf(heard, complaint.tolerance_percent ?? WITHIN));
    byId("unit-heard").textContent = first && `${first}${heard.map(words).join("; ")}.`;
  }
}
