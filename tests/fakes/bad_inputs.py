"""Inputs that cannot be computed, with the field at fault: in SI for Python, as a case elsewhere."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from fe_contact.analysis.analyze import analyze
from fe_contact.geometry import FlankModification, Gear, GearPair
from fe_contact.material import Material

MM, UM, DEG = 1e-3, 1e-6, math.pi / 180.0
Table = dict[str, Any]

GOOD: Table = {
    "pair": {
        "normal_module_mm": 4.0,
        "center_distance_mm": 80.0,
        "pinion": {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0},
        "wheel": {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0},
    },
    "load": {"torque_n_m": [10.0, 100.0]},
}


@dataclass(frozen=True)
class BadInput:
    """One input: the call that raises, the ending of the field it names; the same as `changes` of a case
    (`DROP` removes a field), and the field that its entry points name.
    """

    name: str
    python: Callable[[], object]
    python_field: str
    changes: Table = field(default_factory=dict)
    case_field: str = ""

    def case(self) -> Table:
        found = copy.deepcopy(GOOD)
        for path, value in self.changes.items():
            *tables, last = path.split(".")
            place = found
            for table in tables:
                place = place.setdefault(table, {})
            if value is DROP:
                del place[last]
            else:
                place[last] = value
        return found


DROP = object()


def gear(**changes: Any) -> Gear:
    return Gear(
        **{"teeth": 20, "normal_module": 4 * MM, "face_width": 25 * MM, "bore_diameter": 40 * MM} | changes
    )


def pair(pinion: Table | None = None, wheel: Table | None = None, distance: float = 80 * MM) -> GearPair:
    return GearPair(gear(**pinion or {}), gear(**wheel or {}), distance)


def helical() -> GearPair:
    """Return helical gears of the good pair's teeth."""
    return GearPair(gear(helix_angle=15 * DEG), gear(helix_angle=-15 * DEG), 80 * MM / math.cos(15 * DEG))


def crowned() -> GearPair:
    return pair({"modification": FlankModification(helix_crowning=5 * UM)})


def run(**arguments: Any) -> object:
    """Call the main flow on the good pair."""
    return analyze(pair(), **({"torques": [10.0, 100.0]} | arguments))


def of_gear(name: str, si: str, value: Any, case: str, shown: Any, at: str = "") -> BadInput:
    path = f"pair.pinion.{case}"
    return BadInput(name, lambda: gear(**{si: value}), si, {path: shown}, at or path)


def of_flank(name: str, si: Table, at: str, shown: Table, case_at: str) -> BadInput:
    changes = {f"pair.pinion.{key}": value for key, value in shown.items()}
    return BadInput(
        name, lambda: gear(modification=FlankModification(**si)), at, changes, f"pair.pinion.{case_at}"
    )


def of_run(name: str, si: Table, at: str, shown: Table, case_at: str) -> BadInput:
    """Return a wrong argument of the main flow."""
    return BadInput(name, lambda: run(**si), at, shown, case_at)


NAN = float("nan")
PLANE = {"model": "plane_strain"}
MISALIGNED = {"accuracy.model": "plane_strain", "errors.misalignment_um": [0.0, 30.0]}

BAD_INPUTS: tuple[BadInput, ...] = (
    of_gear("too few teeth", "teeth", 3, "teeth", 3),
    of_gear("negative teeth", "teeth", -20, "teeth", -20),
    of_gear("fractional teeth", "teeth", 20.5, "teeth", 20.5),
    of_gear("too many teeth", "teeth", 5000, "teeth", 5000),
    of_gear("no face width", "face_width", 0.0, "face_width_mm", 0.0),
    of_gear("negative face width", "face_width", -25 * MM, "face_width_mm", -25.0),
    of_gear("face width no number", "face_width", NAN, "face_width_mm", NAN),
    of_gear("face width infinite", "face_width", math.inf, "face_width_mm", math.inf),
    of_gear("face width in quotes", "face_width", "25", "face_width_mm", "25"),
    of_gear("bore of zero", "bore_diameter", 0.0, "bore_diameter_mm", 0.0),
    of_gear("bore beyond the root", "bore_diameter", 95 * MM, "bore_diameter_mm", 95.0),
    of_gear("root radius too large", "root_radius_coefficient", 0.6, "root_radius_coefficient", 0.6),
    of_gear("negative root radius", "root_radius_coefficient", -0.1, "root_radius_coefficient", -0.1),
    of_gear("no addendum", "addendum_coefficient", 0.0, "addendum_coefficient", 0.0),
    of_gear("dedendum beyond reason", "dedendum_coefficient", 9.0, "dedendum_coefficient", 9.0),
    of_gear("shift beyond reason", "profile_shift_coefficient", 6.0, "profile_shift_coefficient", 6.0),
    of_gear("negative allowance", "thickness_allowance", -10 * UM, "thickness_allowance_um", -10.0),
    of_gear("tip below the root", "tip_diameter", 60 * MM, "tip_diameter_mm", 60.0),
    BadInput(
        "pointed tooth",
        lambda: gear(tip_diameter=100 * MM),
        "tip_diameter",
        {"pair.pinion.tip_diameter_mm": 100.0},
        "pair.pinion.tip_diameter_mm",
    ),
    BadInput(
        "negative module",
        lambda: gear(normal_module=-4 * MM),
        "normal_module",
        {"pair.normal_module_mm": -4.0},
        "pair.normal_module_mm",
    ),
    BadInput(
        "pressure angle",
        lambda: gear(normal_pressure_angle=50 * DEG),
        "normal_pressure_angle",
        {"pair.normal_pressure_angle_deg": 50.0},
        "pair.normal_pressure_angle_deg",
    ),
    BadInput(
        "helix angle",
        lambda: gear(helix_angle=80 * DEG),
        "helix_angle",
        {"pair.helix_angle_deg": 80.0},
        "pair.helix_angle_deg",
    ),
    BadInput(
        "center distance too short",
        lambda: pair(distance=70 * MM),
        "center_distance",
        {"pair.center_distance_mm": 70.0},
        "pair.center_distance_mm",
    ),
    BadInput(
        "center distance too long",
        lambda: pair(distance=88.5 * MM),
        "center_distance",
        {"pair.center_distance_mm": 88.5},
        "pair.center_distance_mm",
    ),
    BadInput(
        "center distance negative",
        lambda: pair(distance=-80 * MM),
        "center_distance",
        {"pair.center_distance_mm": -80.0},
        "pair.center_distance_mm",
    ),
    of_flank(
        "relief without length",
        {"tip_relief": 20 * UM},
        "tip_relief_length",
        {"tip_relief_um": 20.0},
        "tip_relief_length_mm",
    ),
    of_flank(
        "relief longer than the tooth",
        {"tip_relief": 20 * UM, "tip_relief_length": 50 * MM},
        "tip_relief_length",
        {"tip_relief_um": 20.0, "tip_relief_length_mm": 50.0},
        "tip_relief_length_mm",
    ),
    of_flank(
        "negative relief",
        {"tip_relief": -20 * UM, "tip_relief_length": MM},
        "tip_relief",
        {"tip_relief_um": -20.0, "tip_relief_length_mm": 1.0},
        "tip_relief_um",
    ),
    of_flank(
        "unknown relief shape",
        {"tip_relief_shape": "wavy"},
        "tip_relief_shape",
        {"tip_relief_shape": "wavy"},
        "tip_relief_shape",
    ),
    of_flank(
        "negative tip rounding",
        {"tip_rounding": -0.2 * MM},
        "tip_rounding",
        {"tip_rounding_mm": -0.2},
        "tip_rounding_mm",
    ),
    of_flank(
        "chamfer higher than the usable flank",
        {"tip_chamfer": 20 * MM},
        "tip_chamfer",
        {"tip_chamfer_mm": 20.0},
        "tip_chamfer_mm",
    ),
    of_flank(
        "rounding that does not fit the tip",
        {"tip_rounding": 5 * MM},
        "tip_rounding",
        {"tip_rounding_mm": 5.0},
        "tip_rounding_mm",
    ),
    of_flank(
        "chamfer along the flank",
        {"tip_chamfer": 0.2 * MM, "tip_chamfer_angle": 0.0},
        "tip_chamfer_angle",
        {"tip_chamfer_mm": 0.2, "tip_chamfer_angle_deg": 0.0},
        "tip_chamfer_angle_deg",
    ),
    of_flank(
        "tip rounded and chamfered",
        {"tip_rounding": 0.2 * MM, "tip_chamfer": 0.2 * MM},
        "tip_chamfer",
        {"tip_rounding_mm": 0.2, "tip_chamfer_mm": 0.2},
        "tip_chamfer_mm",
    ),
    of_flank(
        "hollow profile",
        {"profile_crowning": -5 * UM},
        "profile_crowning",
        {"profile_crowning_um": -5.0},
        "profile_crowning_um",
    ),
    BadInput(
        "no stiffness",
        lambda: gear(material=Material(youngs_modulus=0.0)),
        "youngs_modulus",
        {"material.youngs_modulus_gpa": 0.0},
        "material.youngs_modulus_gpa",
    ),
    BadInput(
        "incompressible",
        lambda: gear(material=Material(poissons_ratio=0.5)),
        "poissons_ratio",
        {"material.poissons_ratio": 0.5},
        "material.poissons_ratio",
    ),
    of_run("no load", {"torques": None}, "torques", {"load": {}}, "load.torque_n_m"),
    of_run(
        "two kinds of load",
        {"normal_forces": [100.0]},
        "torques",
        {"load.normal_force_n": [100.0]},
        "load.torque_n_m",
    ),
    of_run("empty list of loads", {"torques": []}, "torques", {"load.torque_n_m": []}, "load.torque_n_m"),
    of_run(
        "zero load",
        {"torques": [0.0, 10.0]},
        "torques[0]",
        {"load.torque_n_m": [0.0, 10.0]},
        "load.torque_n_m[0]",
    ),
    of_run(
        "loads out of order",
        {"torques": [100.0, 10.0]},
        "torques",
        {"load.torque_n_m": [100.0, 10.0]},
        "load.torque_n_m",
    ),
    of_run(
        "repeated load",
        {"torques": [10.0, 10.0]},
        "torques",
        {"load.torque_n_m": [10.0, 10.0]},
        "load.torque_n_m",
    ),
    of_run(
        "tolerance of zero",
        {"tolerance": 0.0},
        "tolerance",
        {"accuracy.tolerance": 0.0},
        "accuracy.tolerance",
    ),
    of_run(
        "two wishes",
        {"tolerance": 0.01, "level": "fine"},
        "level",
        {"accuracy.tolerance": 0.01, "accuracy.level": "fine"},
        "accuracy.level",
    ),
    of_run("unknown level", {"level": "superb"}, "level", {"accuracy.level": "superb"}, "accuracy.level"),
    of_run("unknown model", {"model": "4d"}, "model", {"accuracy.model": "4d"}, "accuracy.model"),
    of_run(
        "no time",
        {"time_budget": -1.0},
        "time_budget",
        {"accuracy.time_budget_s": -1.0},
        "accuracy.time_budget_s",
    ),
    of_run(
        "too few positions", {"positions": 1}, "positions", {"accuracy.positions": 1}, "accuracy.positions"
    ),
    of_run(
        "unknown effect",
        {"effects": {"magic": "on"}},
        "effects.magic",
        {"effects.magic": "on"},
        "effects.magic",
    ),
    of_run(
        "unknown switch",
        {"effects": {"corner_contact": "maybe"}},
        "effects.corner_contact",
        {"effects.corner_contact": "maybe"},
        "effects.corner_contact",
    ),
    of_run(
        "misalignment in a plane model",
        PLANE | {"misalignments": (0.0, 30 * UM)},
        "misalignments",
        MISALIGNED,
        "errors.misalignment_um",
    ),
    of_run(
        "misalignments out of order",
        {"misalignments": (30 * UM, 0.0)},
        "misalignments",
        {"errors.misalignment_um": [30.0, 0.0]},
        "errors.misalignment_um",
    ),
    BadInput(
        "helical gears in a plane model",
        lambda: analyze(helical(), torques=[100.0], model="plane_strain"),
        "pinion.helix_angle",
        {
            "pair.helix_angle_deg": 15.0,
            "pair.center_distance_mm": 80.0 / math.cos(15 * DEG),
            "accuracy.model": "plane_strain",
        },
        "pair.helix_angle_deg",
    ),
    BadInput(
        "lead crowning in a plane model",
        lambda: analyze(crowned(), torques=[100.0], model="plane_strain"),
        "pinion.modification.helix_crowning",
        {"pair.pinion.helix_crowning_um": 5.0, "accuracy.model": "plane_strain"},
        "pair.pinion.helix_crowning_um",
    ),
)

# What only a file can get wrong: Python itself refuses these calls.
BAD_FILES: tuple[BadInput, ...] = (
    BadInput("misspelt field", lambda: None, "", {"pair.pinion.teht": 20}, "pair.pinion.teht"),
    BadInput("missing field", lambda: None, "", {"pair.wheel.teeth": DROP}, "pair.wheel.teeth"),
    BadInput("missing table", lambda: None, "", {"pair.wheel": DROP}, "pair.wheel"),
    BadInput("table no table", lambda: None, "", {"pair.pinion": 20}, "pair.pinion"),
    BadInput("number for a list", lambda: None, "", {"load.torque_n_m": 100.0}, "load.torque_n_m"),
    BadInput(
        "true for a number", lambda: None, "", {"pair.center_distance_mm": True}, "pair.center_distance_mm"
    ),
)
