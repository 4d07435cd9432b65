"""Gear pairs as data sheets, standards and papers print them, as cases (tests/reference/printed_pairs.csv).

`kind` says what is printed in the source: "published" all of the macro-geometry, "part" some of it, "design"
none: a pair worked out without backlash and rounded as a sheet prints it. Bore, rim and cutter are ours.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from lineofaction.gearbox.schemas import Case, validated

FILE = Path(__file__).parents[1] / "reference" / "printed_pairs.csv"
RACK = ("addendum_coefficient", "dedendum_coefficient", "root_radius_coefficient")

Row = dict[str, str]


def printed_pairs() -> list[Row]:
    with FILE.open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def printed_case(row: Row, model: str = "auto") -> Case:
    """Return the case of a row, every number as it is printed, at 100 N per mm of face and mm of module."""
    module, width = float(row["normal_module_mm"]), float(row["face_width_mm"])
    shared = ("normal_module_mm", "normal_pressure_angle_deg", "helix_angle_deg", "center_distance_mm")
    pair = {name: float(row[name]) for name in shared}
    pair |= {"pinion": _gear(row, 1), "wheel": _gear(row, 2)}
    accuracy = {"level": "draft", "model": model, "receipt": "minimal"}
    load = {"normal_force_n": [100.0 * module * width]}
    return validated(Case, {"pair": pair, "load": load, "accuracy": accuracy})


def _gear(row: Row, index: int) -> dict[str, Any]:
    """Return one gear of a row; a negative number of teeth is a ring gear."""
    teeth, module = int(row[f"teeth_{index}"]), float(row["normal_module_mm"])
    diameter = abs(teeth) * module
    gear: dict[str, Any] = {
        "teeth": abs(teeth),
        "face_width_mm": float(row["face_width_mm"]),
        "profile_shift_coefficient": float(row[f"x_{index}"]),
    }
    if tip := row[f"tip_diameter_{index}_mm"]:
        gear["tip_diameter_mm"] = float(tip)
    rack = {name: float(row[name]) for name in RACK if row[name]}
    if teeth > 0:
        return gear | rack | {"bore_diameter_mm": round(0.4 * diameter, 1)}
    rack.pop("root_radius_coefficient", None)  # that of the pinion's rack; a ring's is its cutter's
    return gear | rack | {"internal": True, "rim_diameter_mm": round(diameter + 14.0 * module, 1)}
