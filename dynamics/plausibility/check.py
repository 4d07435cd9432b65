"""The plausibility checks of scenes: quantity, limits, source."""

from __future__ import annotations

from bounds import Check, Checklist

_STEEL = "from foamed plastics to tungsten"
_CHECKS = (
    Check("duration", "duration of the run", 1e-4, 300.0, "s", "run-ups take 1 to 120 s"),
    Check(
        "pitch_line_speed",
        "speed of the base circle of the fastest gear",
        None,
        300.0,
        "m/s",
        "ISO 6336-1: turbo gears reach 200 to 250 m/s",
    ),
    Check(
        "support_stiffness",
        "stiffness of a bearing that is not 0",
        5e5,
        1e12,
        "N/m",
        "rolling bearings: 1e7 to 1e10 N/m; soft mounts: 1e6 N/m",
    ),
    Check(
        "damping_ratio",
        "damping ratio of a bearing or a mesh",
        None,
        1.0,
        "1",
        "measured gear meshes and bearings: 0.02 to 0.2; 1 is critical",
    ),
    Check(
        "material_damping",
        "damping ratio of a shaft's material",
        None,
        0.2,
        "1",
        "steel: 0.0005 to 0.01; elastomers: 0.1",
    ),
    Check(
        "clearance",
        "radial clearance of a bearing that is not 0",
        0.1e-6,
        5e-3,
        "m",
        "ISO 5753-1: 1 um to 1 mm",
    ),
    Check("backlash", "backlash of a mesh", 0.5e-6, 20e-3, "m", "DIN 3967: 10 um to 3 mm"),
    Check(
        "friction",
        "coefficient of friction of the teeth",
        1e-3,
        0.5,
        "1",
        "ISO/TR 14179-1: lubricated teeth 0.02 to 0.1; dry steel 0.3",
    ),
    Check(
        "mesh_misalignment",
        "misalignment of a mesh that is not 0",
        0.1e-6,
        None,
        "m",
        "ISO 1328-1: class 1 allows about 1 um",
    ),
    Check(
        "mesh_misalignment_over_face",
        "misalignment of a mesh over its face width",
        None,
        0.02,
        "1",
        "ISO 6336-1: mesh misalignments are below 0.002",
    ),
    Check(
        "shaft_slenderness",
        "length of a shaft over its largest diameter",
        0.05,
        200.0,
        "1",
        "shafts of gearboxes: 0.5 to 30",
    ),
    Check("shaft_density", "density of a shaft", 500.0, 20e3, "kg/m^3", _STEEL),
    Check(
        "shaft_modulus",
        "Young's modulus of a shaft",
        0.1e9,
        700e9,
        "Pa",
        "from elastomers (0.1 GPa) to tungsten carbide (690 GPa)",
    ),
    Check(
        "mass",
        "mass of a shaft with its gears that bearings carry",
        1e-6,
        None,
        "kg",
        "bodies have mass; without it their motion has no natural frequency",
    ),
    Check(
        "gear_inertia",
        "radius of gyration of a gear over its base radius",
        0.1,
        5.0,
        "1",
        "a disc has 0.7, a ring gear with its rim 1 to 1.5",
    ),
    Check(
        "shaft_inertia",
        "radius of gyration of a shaft over its length",
        None,
        20.0,
        "1",
        "the rotor of a wind turbine: 10",
    ),
    Check(
        "support",
        "bearings of a shaft that mesh forces push aside, in a scene that has bearings",
        None,
        None,
        "1",
        "a shaft without bearings is held rigidly: its forces go nowhere",
    ),
    Check(
        "mesh_load",
        "nominal mesh force over face width and module, of a mesh without a coast flank",
        0.05e6,
        None,
        "Pa",
        "ISO 6336-3: rated gears carry 30 to 150 N/mm^2",
    ),
    Check(
        "mesh_overload",
        "nominal mesh force over face width and module",
        None,
        1000e6,
        "Pa",
        "ISO 6336-3: practice is 30 to 300 N/mm^2",
    ),
)
CHECKS: dict[str, Check] = {check.name: check for check in _CHECKS}
"""All checks by name."""

assessed = Checklist(CHECKS).assessed
