"""Inputs that cannot be computed, with the field at fault: in SI for Python, as a case elsewhere."""

import copy
import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fe_contact import FlankModification, Gear, GearPair, Material, analyze

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
    changes: Table = dataclasses.field(default_factory=dict)
    field: str = ""
    subject = "case"
    process = "analyze"

    def table(self) -> Table:
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
UNITS = {"_mm": MM, "_um": UM, "_deg": DEG, "_gpa": 1e9}
IN_PYTHON = {
    "load.torque_n_m": "torques",
    "load.normal_force_n": "normal_forces",
    "errors.misalignment_um": "misalignments",
    "errors.center_distance_change_mm": "center_distance_changes",
    "_budget_s": "_budget",
}


def in_si(shown: Table) -> Table:
    """Return fields of a case as Python has them."""
    fields = {}
    for name, value in shown.items():
        unit = next((unit for unit in UNITS if name.endswith(unit)), "")
        number = isinstance(value, int | float) and unit
        fields[name.removesuffix(unit)] = UNITS[unit] * value if number else value
    return fields


def gear(**changes: Any) -> Gear:
    return Gear(
        **{"teeth": 20, "normal_module": 4 * MM, "face_width": 25 * MM, "bore_diameter": 40 * MM} | changes
    )


def helical() -> GearPair:
    return GearPair(gear(helix_angle=15 * DEG), gear(helix_angle=-15 * DEG), 80 * MM / math.cos(15 * DEG))


def crowned() -> GearPair:
    return GearPair(gear(modification=FlankModification(helix_crowning=5 * UM)), gear(), 80 * MM)


def run(**arguments: Any) -> object:
    return analyze(GearPair(gear(), gear(), 80 * MM), **({"torques": [10.0, 100.0]} | arguments))


def of_gear(name: str, shown: str, value: Any, table: str = "pair.pinion") -> BadInput:
    ((si, number),) = in_si({shown: value}).items()
    path = f"{table}.{shown}"
    return BadInput(name, lambda: gear(**{si: number}), si, {path: value}, path)


def of_pair(name: str, shown: str, value: float) -> BadInput:
    return of_gear(name, shown, value, "pair")


def of_distance(name: str, value: float) -> BadInput:
    path = "pair.center_distance_mm"
    return BadInput(
        name, lambda: GearPair(gear(), gear(), MM * value), "center_distance", {path: value}, path
    )


def of_flank(name: str, at: str, **shown: Any) -> BadInput:
    """Return a wrong modification of the pinion, refused at a field."""
    (at_in_python,) = in_si({at: None})
    changes = {f"pair.pinion.{key}": value for key, value in shown.items()}
    made = in_si(shown)
    return BadInput(
        name,
        lambda: gear(modification=FlankModification(**made)),
        at_in_python,
        changes,
        f"pair.pinion.{at}",
    )


def of_material(name: str, shown: str, value: float) -> BadInput:
    ((si, number),) = in_si({shown: value}).items()
    path = f"material.{shown}"
    return BadInput(name, lambda: gear(material=Material(**{si: number})), si, {path: value}, path)


def of_run(name: str, si: Table, at: str, shown: Any) -> BadInput:
    """Return a wrong argument of the main flow, refused at a field: what it is in a case, or all changes."""
    in_python = at.removeprefix("accuracy.")
    for path, argument in IN_PYTHON.items():
        in_python = in_python.replace(path, argument)
    changes = shown if isinstance(shown, dict) else {at.partition("[")[0]: shown}
    return BadInput(name, lambda: run(**si), in_python, changes, at)


def of_plane(name: str, make: Callable[[], GearPair], si: str, at: str, **shown: Any) -> BadInput:
    changes = {f"pair.{path}": value for path, value in shown.items()} | {"accuracy.model": "plane_strain"}
    return BadInput(
        name, lambda: analyze(make(), torques=[100.0], model="plane_strain"), si, changes, f"pair.{at}"
    )


def of_file(name: str, path: str, value: Any) -> BadInput:
    return BadInput(name, lambda: None, "", {path: value}, path)


NAN = float("nan")
WISHES: Table = {"tolerance": 0.01, "level": "fine"}
MISALIGNED: Table = {"model": "plane_strain", "misalignments": (0.0, 30 * UM)}
TORQUE, FORCE = "load.torque_n_m", "load.normal_force_n"
SKEW, DISTANCE = "errors.misalignment_um", "errors.center_distance_change_mm"

BAD_INPUTS: tuple[BadInput, ...] = (
    of_gear("too few teeth", "teeth", 3),
    of_gear("fractional teeth", "teeth", 20.5),
    of_gear("no face width", "face_width_mm", 0.0),
    of_gear("face width no number", "face_width_mm", NAN),
    of_gear("face width infinite", "face_width_mm", math.inf),
    of_gear("face width in quotes", "face_width_mm", "25"),
    of_gear("bore beyond the root", "bore_diameter_mm", 95.0),
    of_gear("root radius too large", "root_radius_coefficient", 0.6),
    of_gear("tip below the root", "tip_diameter_mm", 60.0),
    of_gear("pointed tooth", "tip_diameter_mm", 100.0),
    of_pair("pressure angle", "normal_pressure_angle_deg", 50.0),
    of_pair("helix angle", "helix_angle_deg", 80.0),
    of_distance("center distance too short", 70.0),
    of_distance("center distance too long", 88.5),
    of_flank("relief without length", "tip_relief_length_mm", tip_relief_um=20.0),
    of_flank(
        "relief that is a step", "tip_relief_length_mm", tip_relief_um=20.0, tip_relief_length_mm=1e-300
    ),
    of_flank(
        "relief longer than the tooth", "tip_relief_length_mm", tip_relief_um=20.0, tip_relief_length_mm=50.0
    ),
    of_flank("unknown relief shape", "tip_relief_shape", tip_relief_shape="wavy"),
    of_flank("chamfer higher than the usable flank", "tip_chamfer_mm", tip_chamfer_mm=20.0),
    of_flank("rounding that does not fit the tip", "tip_rounding_mm", tip_rounding_mm=5.0),
    of_flank("tip rounded and chamfered", "tip_chamfer_mm", tip_rounding_mm=0.2, tip_chamfer_mm=0.2),
    of_material("no stiffness", "youngs_modulus_gpa", 0.0),
    of_material("incompressible", "poissons_ratio", 0.5),
    of_run("no load", {"torques": None}, TORQUE, {"load": {}}),
    of_run("two kinds of load", {"normal_forces": [100.0]}, TORQUE, {"load.normal_force_n": [100.0]}),
    of_run("empty list of loads", {"torques": []}, TORQUE, []),
    of_run("zero load", {"torques": [0.0, 10.0]}, f"{TORQUE}[0]", [0.0, 10.0]),
    of_run("loads out of order", {"torques": [100.0, 10.0]}, TORQUE, [100.0, 10.0]),
    of_run("repeated load", {"torques": [10.0, 10.0]}, TORQUE, [10.0, 10.0]),
    of_run("tolerance of zero", {"tolerance": 0.0}, "accuracy.tolerance", 0.0),
    of_run(
        "two wishes", WISHES, "accuracy.level", {f"accuracy.{name}": wish for name, wish in WISHES.items()}
    ),
    of_run("unknown level", {"level": "superb"}, "accuracy.level", "superb"),
    of_run("unknown model", {"model": "4d"}, "accuracy.model", "4d"),
    of_run("no time", {"time_budget": -1.0}, "accuracy.time_budget_s", -1.0),
    of_run("too few positions", {"positions": 1}, "accuracy.positions", 1),
    of_run("unknown effect", {"effects": {"magic": "on"}}, "effects.magic", "on"),
    of_run("unknown switch", {"effects": {"corner_contact": "maybe"}}, "effects.corner_contact", "maybe"),
    of_run(
        "misalignment in a plane model",
        MISALIGNED,
        SKEW,
        {"accuracy.model": "plane_strain", SKEW: [0.0, 30.0]},
    ),
    of_run("misalignments out of order", {"misalignments": (30 * UM, 0.0)}, SKEW, [30.0, 0.0]),
    of_run(
        "repeated force",
        {"torques": None, "normal_forces": [100.0, 100.0]},
        FORCE,
        {"load": {"normal_force_n": [100.0, 100.0]}},
    ),
    of_run("distances out of order", {"center_distance_changes": (1e-4, 0.0)}, DISTANCE, [0.1, 0.0]),
    of_plane(
        "helical gears in a plane model",
        helical,
        "pinion.helix_angle",
        "helix_angle_deg",
        helix_angle_deg=15.0,
        center_distance_mm=80.0 / math.cos(15 * DEG),
    ),
    of_plane(
        "lead crowning in a plane model",
        crowned,
        "pinion.modification.helix_crowning",
        "pinion.helix_crowning_um",
        **{"pinion.helix_crowning_um": 5.0},
    ),
)

# What only a file can get wrong: Python itself refuses these calls.
BAD_FILES: tuple[BadInput, ...] = (
    of_file("misspelt field", "pair.pinion.teht", 20),
    of_file("missing field", "pair.wheel.teeth", DROP),
    of_file("missing table", "pair.wheel", DROP),
    of_file("table no table", "pair.pinion", 20),
    of_file("number for a list", "load.torque_n_m", 100.0),
    of_file("true for a number", "pair.center_distance_mm", True),
)
