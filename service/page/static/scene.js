/** A scene of dynamics around an analyzed pair: two shafts, four elastic bearings, motor and brake. */

const SPAN = 200;

/**
 * @param {object} known the analyzed pair: its case and the hash of its table
 * @param {{top_rpm: number, duration_s: number, torque_n_m: number}} wish torque of the brake on the driven gear
 */
export function sceneOf(known, wish) {
  const { pair } = known.case;
  const shaft = (name, gear, x) => ({ name, length_mm: SPAN, diameter_mm: pair[gear].bore_diameter_mm, origin_mm: [x, 0, 0] });
  const gear = (name, on) => ({
    name, shaft: on, position_mm: SPAN / 2, bore_diameter_mm: pair[name].bore_diameter_mm,
  });
  const bearing = (on, side, place) => ({
    name: `${on} ${side}`, shaft: on, position_mm: place, radial_stiffness_n_per_m: 1e8, axial_stiffness_n_per_m: 1e8,
    damping_ratio: 0.05,
  });
  return {
    run: { duration_s: wish.duration_s },
    effects: { flexible_shafts: "off" },
    shafts: [shaft("input", "pinion", 0), shaft("output", "wheel", pair.center_distance_mm)],
    gears: [gear("pinion", "input"), gear("wheel", "output")],
    bushings: ["input", "output"].flatMap((on) => [bearing(on, "left", 0), bearing(on, "right", SPAN)]),
    meshes: [{
      name: "mesh", driver: "pinion", driven: "wheel", database_hash: known.key, technique: "variable_torque", damping_ratio: 0.1,
    }],
    drives: [{ name: "motor", shaft: "input", time_s: [0, wish.duration_s], speed_rpm: [0, wish.top_rpm] }],
    loads: [{ name: "brake", shaft: "output", torque_n_m: [wish.torque_n_m] }],
    outputs: { bearing_forces: true },
  };
}

/** The wish of which a scene was made. @param {any} scene */
export function wishOf({ run, drives, loads }) {
  return { top_rpm: drives?.[0]?.speed_rpm.at(-1), duration_s: run.duration_s, torque_n_m: loads?.[0]?.torque_n_m[0] };
}
