"""The gears of a case as made: as an inspection measured one, or drawn within a class of ISO 1328-1:2013.

An inspection *sheet* is a table of measured deviations. *Drawn* gears have random deviations.
"""

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
"""Fields for the pitches of a gear. A gear has one of them; a new one replaces either."""
_IN_TOLERANCE = 3.0
"""Tolerance over the standard deviation of a drawn figure. Larger figures are clipped to the tolerance."""
_ECCENTRICITY = (0.2, 0.8)
"""Range of a drawn eccentricity, over the one that alone would use up the tolerance of the pitches."""


@dataclass(frozen=True)
class Inspected:
    """The inspected gear of a case, and how its sheet is evaluated."""

    gear: str
    """Name of the gear, one of `GEARS`."""
    loaded: Flank
    """The flanks of that gear that carry the load."""
    cutoff_mm: float | None
    """Cutoff wavelength of the filter for traces, mm; None: the default of the evaluation."""
    mean_of_others: bool = False
    """Whether a tooth that was not measured has the mean flank of the measured ones; else the designed flank.
    """

    def chart(self, case: Case) -> Chart:
        """Return the chart from the sheet's teeth to their sequence in mesh."""
        return Chart(_gear(case, self.gear), self.loaded, self.gear == "pinion")


def measured_case(
    case: Case, text: str, name: str, of: Inspected, values: str | None = None
) -> tuple[Case, MeasuredGear]:
    """Return a case with the deviations of one gear from the `text` of a sheet, and the measured gear.

    `name` is that of the sheet. `values` is the text of a machine's value file for the same gear.
    Raises `BadInput`: an invalid line, a trace that cannot be evaluated, or an impossible gear.
    """
    chart = of.chart(case)
    cutoff = None if of.cutoff_mm is None else of.cutoff_mm * MM
    sheet = read_sheet(text, chart.gear, name, values)
    gear = measured_gear(sheet, chart, name, cutoff, mean_of_others=of.mean_of_others)
    return _with_fields(case, {of.gear: gear.fields}), gear


def drawn_case(case: Case, tolerance_class: int, seed: int = 0) -> Case:
    """Return a case with deviations of both gears drawn within a tolerance class.

    They replace the deviations of the case, except waves. Raises `BadInput`: an unknown class, or a gear
    beyond the range of the standard.
    """
    draw = np.random.default_rng(seed)
    with boundary_errors():
        drawn = {name: _drawn(_gear(case, name), tolerance_class, draw) for name in GEARS}
    return _with_fields(case, drawn)


def _gear(case: Case, name: str) -> Toothing:
    gear: Toothing = getattr(gear_pair(case), name)
    return gear


def _with_fields(case: Case, fields: Mapping[str, Mapping[str, Any]]) -> Case:
    """Return the case with some fields of its gears replaced; raises `BadInput` for an impossible pair."""
    content = case_json(case)
    for name, replacement in fields.items():
        replaced = set(replacement)
        if replaced & set(_PITCHES):
            replaced |= set(_PITCHES)
        unchanged = {key: value for key, value in content["pair"][name].items() if key not in replaced}
        content["pair"][name] = {**unchanged, **replacement}
    changed = validated(Case, content)
    gear_pair(changed)
    return changed


def _drawn(gear: Toothing, tolerance_class: int, draw: np.random.Generator) -> dict[str, Any]:
    """Return the fields of a gear within a class: run-out, pitches, slopes and forms of every tooth.

    Figures are normally distributed, with the tolerance at three standard deviations. Run-out and pitches
    share the tolerance of the pitches. Only helical gears get helix deviations, so that a spur pair stays a
    plane problem.
    """
    pitches = PitchBounds.of(gear, tolerance_class)
    eccentricity = draw.uniform(*_ECCENTRICITY) * pitches.eccentricity
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
    """Return normally distributed figures (count,) within +-limit."""
    return np.clip(draw.normal(0.0, limit / _IN_TOLERANCE, count), -limit, limit)


def _um(values: FloatArray) -> list[float]:
    """Return lengths in um to three decimals; + 0.0 turns -0 into 0."""
    return [float(value) for value in np.round(values / UM, 3) + 0.0]
