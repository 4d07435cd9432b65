"""Tolerances of flanks by ISO 1328-1:2013, and the misalignment that a class of gears and housing allows.

Pitch, run-out, slope and form of profile and helix: formulas, range and rounding of clause 5. ANSI/AGMA ISO
1328-1-B14 and DIN ISO 1328-1:2018 are the same text. The edition of 1995 has other formulas, in grades 0 to
12: its figures are not those of a class of equal number.

References
----------
.. [1] ISO 1328-1:2013, 5.3: tolerances of pitch, profile and helix; annex E: of run-out.
.. [2] ISO/TR 10064-3:1996, clause 5: parallelism of axes in their plane and out of it, by the span L of the
   bearings: f_Sigma_beta = 0.5 (L/b) F_beta, f_Sigma_delta = 2 f_Sigma_beta.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

from bounds.pitch_tolerance import RUN_OUT_SHARE, cumulative_pitch_of_class
from fe_contact.errors import InputError, integer, within
from fe_contact.geometry.parallel_axes import ParallelAxes
from fe_contact.geometry.toothing import Toothing

_REMEDY = "ISO 1328-1:2013, 5.2.1 has no tolerances beyond: give your own figures."

NO_CLEARANCE = (0.0, 0.0)


def single_pitch_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """Return the single pitch tolerance f_pT in m: formula (5) of 5.3.2."""
    return _of_class(_class_5(gear).single_pitch, tolerance_class)


def cumulative_pitch_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """Return the cumulative pitch tolerance F_pT in m: formula (6) of 5.3.2."""
    return _of_class(_class_5(gear).cumulative_pitch, tolerance_class)


def run_out_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """Return the run-out tolerance F_rT in m: 0.9 F_pT, which is not rounded before (annex E)."""
    return _of_class(RUN_OUT_SHARE * _class_5(gear).cumulative_pitch, tolerance_class)


def profile_slope_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """Return the profile slope tolerance f_HalphaT in m: formula (7) of 5.3.3.1."""
    return _of_class(_class_5(gear).profile_slope, tolerance_class)


def profile_form_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """Return the profile form tolerance f_falphaT in m: formula (8) of 5.3.3.2."""
    return _of_class(_class_5(gear).profile_form, tolerance_class)


def profile_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """Return F_alphaT in m: the root of the sum of squares of slope and form, neither rounded before."""
    fifth = _class_5(gear)
    return _of_class(math.hypot(fifth.profile_slope, fifth.profile_form), tolerance_class)


def helix_slope_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """Return the helix slope tolerance f_HbetaT in m: formula (10) of 5.3.4.1."""
    return _of_class(_class_5(gear).helix_slope, tolerance_class)


def helix_form_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """Return the helix form tolerance f_fbetaT in m: formula (11) of 5.3.4.2."""
    return _of_class(_class_5(gear).helix_form, tolerance_class)


def helix_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """Return F_betaT in m: the root of the sum of squares of slope and form, neither rounded before."""
    fifth = _class_5(gear)
    return _of_class(math.hypot(fifth.helix_slope, fifth.helix_form), tolerance_class)


class _Class5(NamedTuple):
    """Tolerances of class 5, not rounded, um."""

    single_pitch: float
    cumulative_pitch: float
    profile_slope: float
    profile_form: float
    helix_slope: float
    helix_form: float


def _class_5(gear: Toothing) -> _Class5:
    # m_n, d and b in mm
    module, diameter, width = 1e3 * gear.normal_module, 2e3 * gear.reference_radius, 1e3 * gear.face_width
    return _Class5(
        single_pitch=0.001 * diameter + 0.4 * module + 5.0,
        cumulative_pitch=cumulative_pitch_of_class(module, diameter),
        profile_slope=0.4 * module + 0.001 * diameter + 4.0,
        profile_form=0.55 * module + 5.0,
        helix_slope=0.05 * math.sqrt(diameter) + 0.35 * math.sqrt(width) + 4.0,
        helix_form=0.07 * math.sqrt(diameter) + 0.45 * math.sqrt(width) + 4.0,
    )


def _of_class(fifth: float, tolerance_class: int) -> float:
    """Return the tolerance of a class in m by that of class 5 in um, which is not rounded before (5.2.2)."""
    return 1e-6 * rounded(fifth * math.sqrt(2.0) ** (tolerance_class - 5))


def rounded(tolerance: float) -> float:
    """Round a tolerance in um: above 10 to whole ones, from 5 to halves, below to tenths (5.2.3)."""
    parts = 10  # of one um
    if tolerance >= 5.0:
        parts = 1 if tolerance > 10.0 else 2
    return math.floor(tolerance * parts + 0.5) / parts


def check_scope(name: str, gear: Toothing) -> None:
    """Refuse a gear for which the formulas are not made (clause 1)."""
    for field_name, value, low, high in (
        ("teeth", gear.teeth, 5, 1000),
        ("normal_module", gear.normal_module, 0.5e-3, 70e-3),
        ("reference_diameter", 2.0 * gear.reference_radius, 5e-3, 15.0),
        ("face_width", gear.face_width, 4e-3, 1.2),
        ("helix_angle", abs(gear.helix_angle), 0.0, math.radians(45.0)),
    ):
        within(f"{name}.{field_name}", value, low, high, _REMEDY)


@dataclass(frozen=True)
class MisalignmentRange:
    """Misalignment of pairs whose gears and housing meet a class, as growth over the common face width."""

    tolerance_class: int
    by_source: Mapping[str, float]
    """Misalignment by source, m, to either side, in the plane of action."""

    @property
    def likely(self) -> float:
        """Return the root of the sum of squares, m: sources are independent."""
        return math.hypot(*self.by_source.values())

    @property
    def worst(self) -> float:
        """Return the sum, m: all sources at their limits to the same side."""
        return sum(self.by_source.values())

    @property
    def axis(self) -> tuple[float, ...]:
        """Return five values of a table over the likely range, rounded as a tolerance is, m."""
        end = 1e-6 * rounded(1e6 * self.likely)
        return (-end, -0.5 * end, 0.0, 0.5 * end, end)

    @property
    def text(self) -> str:
        """Say how the range is made, in one sentence."""
        parts = ", ".join(f"{name} {1e6 * value:.1f}" for name, value in self.by_source.items())
        return (
            f"misalignment to {1e6 * self.axis[-1]:g} µm to either side by class {self.tolerance_class} of "
            f"ISO 1328-1:2013 and ISO/TR 10064-3: {parts} µm, {1e6 * self.likely:.1f} µm by squares, "
            f"{1e6 * self.worst:.1f} µm at worst"
        )


def misalignment_range(
    pair: ParallelAxes, tolerance_class: int, clearances: tuple[float, float] = NO_CLEARANCE
) -> MisalignmentRange:
    """Return the misalignment of pairs of a class: axes that are not parallel, helix slopes, clearances.

    In the plane of action a deviation in the plane of the axes counts with the sine of the working pressure
    angle, one out of it with the cosine. Over the face width the span of the bearings cancels: the two are
    F_beta sin and F_beta cos / 2, with the larger F_beta of the gears. The slope of a helix opens the flanks
    along the face as a tilt does at the pitch point. A shaft in bearings with a clearance tilts by the
    clearance over their span. Raises `InputError`: no such class, a gear beyond the range of the standard, or
    a clearance without a shaft.

    Parameters
    ----------
    tolerance_class : int
        1 (finest) to 11, of both gears and of the axes.
    clearances : (float, float)
        Radial internal clearance of the bearings of each shaft, m; `pair.shafts` has the shaft.
    """
    integer("tolerance_class", tolerance_class, 1, 11)
    gears = {"pinion": pair.pinion, "wheel": pair.wheel}
    for name, gear in gears.items():
        check_scope(name, gear)
    face, angle = pair.face_width, pair.working_pressure_angle
    deviation = max(
        helix_tolerance(gear, tolerance_class) * face / gear.face_width for gear in gears.values()
    )
    by_source = {
        "axes in their plane": deviation * math.sin(angle),
        "axes out of their plane": 0.5 * deviation * math.cos(angle),
    }
    for name, gear in gears.items():
        slope = helix_slope_tolerance(gear, tolerance_class)
        by_source[f"helix slope of the {name}"] = slope * face / gear.face_width
    for name, shaft, clearance in zip(gears, pair.shafts, clearances, strict=True):
        if clearance == 0.0:
            continue
        if shaft is None:
            remedy = "It tilts over the span of its bearings."
            raise InputError("clearances", clearance, f"0 without the shaft of the {name}", remedy)
        within("clearances", clearance, 0.0, 1e-2)
        by_source[f"bearing clearance of the {name}"] = clearance * face / shaft.length
    return MisalignmentRange(tolerance_class, MappingProxyType(by_source))
