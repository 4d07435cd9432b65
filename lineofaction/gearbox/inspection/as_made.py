"""The gears of a case as made: as an inspection measured one, or drawn within a class of ISO 1328-1:2013."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fe_contact.geometry import Toothing
from fe_contact.geometry.flank_tolerances import (
    helix_form_tolerance,
    helix_slope_tolerance,
    profile_form_tolerance,
    profile_slope_tolerance,
)
from fe_contact.microgeometry.drawn_teeth import PitchBounds
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import case_json, gear_pair
from lineofaction.gearbox.inspection.measured_gear import Chart, MeasuredGear, measured_gear
from lineofaction.gearbox.inspection.reading import read_sheet
from lineofaction.gearbox.inspection.sheet import Flank
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.units import DEGREE, MM, UM

GEARS = ("pinion", "wheel")
_PITCHES = ("pitch_deviation_um", "single_pitch_deviation_um")
_IN_TOLERANCE = 3.0
"""Standard deviations of a drawn figure at its tolerance, where the distribution is cut."""


@dataclass(frozen=True)
class Inspected:
    """The inspected gear of the case, and the loaded flanks of that gear."""

    gear: str
    loaded: Flank
    cutoff_mm: float | None
    mean_of_others: bool = False
    """Whether teeth that were not measured have the mean flank of the others, or the designed one."""

    def chart(self, case: Case) -> Chart:
        """Return the chart from the sheet's teeth to their sequence in mesh."""
        return Chart(_gear(case, self.gear), self.loaded, self.gear == "pinion")


def measured_case(
    case: Case, text: str, name: str, of: Inspected, values: str | None = None
) -> tuple[Case, MeasuredGear]:
    """Return a case with the measured deviations of one gear by a sheet, and the account of its lines.

    `values` is the text of the value file that a machine wrote of the same gear.
    Raises `BadInput`: a line that is none, a trace that cannot be evaluated, or a gear that cannot be.
    """
    chart = of.chart(case)
    cutoff = None if of.cutoff_mm is None else of.cutoff_mm * MM
    sheet = read_sheet(text, chart.gear, name, values)
    gear = measured_gear(sheet, chart, name, cutoff, mean_of_others=of.mean_of_others)
    return _with_fields(case, {of.gear: gear.fields}), gear


def drawn_case(case: Case, tolerance_class: int, seed: int = 0) -> Case:
    """Return a case with both gears drawn within a class, in place of deviations but waves that it had.

    Raises `BadInput`: no such class, or a gear beyond the range of the standard.
    """
    draw = np.random.default_rng(seed)
    with boundary_errors():
        drawn = {name: _drawn(_gear(case, name), tolerance_class, draw) for name in GEARS}
    return _with_fields(case, drawn)


def _gear(case: Case, name: str) -> Toothing:
    gear: Toothing = getattr(gear_pair(case), name)
    return gear


def _with_fields(case: Case, fields: Mapping[str, Mapping[str, Any]]) -> Case:
    """Return the case with other fields of its gears; the case is checked to be computable."""
    content = case_json(case)
    for name, replacement in fields.items():
        replaced = {*replacement, *(_PITCHES if {*replacement} & {*_PITCHES} else ())}
        unchanged = {key: value for key, value in content["pair"][name].items() if key not in replaced}
        content["pair"][name] = {**unchanged, **replacement}
    changed = validated(Case, content)
    gear_pair(changed)
    return changed


def _drawn(gear: Toothing, tolerance_class: int, draw: np.random.Generator) -> dict[str, Any]:
    """Return the fields of a gear within a class: run-out, pitches, slopes and forms of every tooth.

    Figures are normal, three standard deviations in the tolerance. Run-out and pitches share what a class
    allows of pitches. Helix deviations are drawn of helical gears alone, so that a spur pair stays plane.
    """
    pitches = PitchBounds.of(gear, tolerance_class)
    eccentricity = draw.uniform(0.2, 0.8) * pitches.eccentricity
    across = {"helix_slope": helix_slope_tolerance, "helix_form": helix_form_tolerance}
    tolerances = {"profile_slope": profile_slope_tolerance, "profile_form": profile_form_tolerance}
    tolerances |= across if gear.helix_angle else {}
    figures = {
        f"{name}_um": _um(_within(of_class(gear, tolerance_class), gear.teeth, draw))
        for name, of_class in tolerances.items()
    }
    rows = zip(*figures.values(), strict=True)
    steps = _within(pitches.single, gear.teeth, draw)
    walk = pitches.bounded(eccentricity, np.cumsum(steps - steps.mean()))
    return {
        "run_out": {
            "eccentricity_um": round(eccentricity / UM, 3),
            "eccentricity_angle_deg": round(draw.uniform(-math.pi, math.pi) / DEGREE, 1),
        },
        "pitch_deviation_um": _um(walk),
        "tooth_flanks": [
            {"tooth": tooth, **dict(zip(figures, row, strict=True))} for tooth, row in enumerate(rows, 1)
        ],
    }


def _within(limit: float, count: int, draw: np.random.Generator) -> FloatArray:
    return np.clip(draw.normal(0.0, limit / _IN_TOLERANCE, count), -limit, limit)


def _um(values: FloatArray) -> list[float]:
    return [float(value) for value in np.round(values / UM, 3) + 0.0]
