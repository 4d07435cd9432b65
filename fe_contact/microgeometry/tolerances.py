"""Tolerances of assembly and manufacture: how figures are distributed between the limits of inspection."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from scipy.special import ndtr, ndtri

from bounds import SiNote
from fe_contact.errors import InputError, integer, positive, within
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.microgeometry.variables import GEARS, gear_and_quantity
from fe_contact.types import FloatArray, Json

Distribution = Literal["normal", "uniform"]
PROCESS_SPREAD = 3.0
"""Standard deviations of the normal distribution in a tolerance, beyond which parts are rejected."""


@dataclass(frozen=True)
class Tolerances:
    """Half widths of tolerance bands about the design, and the distribution within them.

    Attributes
    ----------
    misalignment : float
        m, >= 0.
    modification : mapping
        ``gear.quantity`` to m, > 0.
    distribution : {"normal", "uniform"}
        Normal: three standard deviations are the tolerance, and deviations beyond are rejected.
    """

    misalignment: float = 0.0
    modification: Mapping[str, float] = field(default_factory=dict)
    distribution: Distribution = "normal"

    def __post_init__(self) -> None:
        if self.misalignment:
            positive("tolerances.misalignment", self.misalignment, SiNote("In m: 10 um is 1e-5."))
        for name, width in self.modification.items():
            gear_and_quantity(f"tolerances.modification.{name}", name)
            positive(f"tolerances.modification.{name}", width, SiNote("In m: 10 um is 1e-5."))
        if self.distribution not in ("normal", "uniform"):
            raise InputError("tolerances.distribution", self.distribution, 'one of "normal" and "uniform"')
        if not self.widths:
            raise InputError("tolerances", {}, "at least one width above 0")

    @property
    def widths(self) -> dict[str, float]:
        """Half width of every deviation, m, in a fixed order."""
        own = {MISALIGNMENT: self.misalignment} if self.misalignment else {}
        return own | dict(sorted(self.modification.items()))

    def sample(self, count: int, seed: int) -> FloatArray:
        """Draw deviations (count, d) in m; a larger sample of the same seed begins with a smaller one."""
        widths = np.array(list(self.widths.values()))
        uniform = np.random.Generator(np.random.PCG64(seed)).random((count, widths.size))
        if self.distribution == "uniform":
            return np.asarray(widths * (2.0 * uniform - 1.0))
        low = ndtr(-PROCESS_SPREAD)
        return np.asarray(widths * ndtri(low + (1.0 - 2.0 * low) * uniform) / PROCESS_SPREAD)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "misalignment_m": self.misalignment,
            "modification_m": dict(self.modification),
            "distribution": self.distribution,
        }


# Tolerances of profile and helix slope by ISO 1328-1:2013: formulas, range and rounding of clause 5.
#
# ANSI/AGMA ISO 1328-1-B14 and DIN ISO 1328-1:2018 are the same text. The edition of 1995 has other formulas,
# in grades 0 to 12: its figures are not those of a class of equal number.

_ADVICE = "ISO 1328-1:2013, 5.2.1 has no tolerances beyond: give your own as Tolerances."


def iso1328_tolerances(
    pair: ParallelAxes,
    tolerance_class: int,
    *,
    misalignment: float = 0.0,
    across_face: bool = True,
    distribution: Distribution = "normal",
) -> Tolerances:
    """Return tolerances of profile and helix slope of both gears by ISO 1328-1:2013.

    Parameters
    ----------
    tolerance_class : int
        1 (finest) to 11.
    misalignment : float
        Of the assembly, m; the standard has none.
    across_face : bool
        Whether helix slopes deviate too; a plane model cannot have it.

    Raises
    ------
    InputError
        No such class, or a gear beyond the range of the standard.
    """
    integer("tolerance_class", tolerance_class, 1, 11)
    widths = {}
    for name in GEARS:
        gear: Toothing = getattr(pair, name)
        _check_scope(name, gear)
        widths[f"{name}.profile_slope"] = _profile_slope_tolerance(gear, tolerance_class)
        if across_face:
            widths[f"{name}.helix_slope"] = _helix_slope_tolerance(gear, tolerance_class)
    return Tolerances(misalignment, widths, distribution)


def _profile_slope_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """f_HalphaT in m: formula (7) of 5.3.3.1, 0.4 m_n + 0.001 d + 4 um of class 5, m_n and d in mm."""
    module, diameter = 1e3 * gear.normal_module, 2e3 * gear.reference_radius
    return 1e-6 * _rounded((0.4 * module + 0.001 * diameter + 4.0) * _step(tolerance_class))


def _helix_slope_tolerance(gear: Toothing, tolerance_class: int) -> float:
    """f_HbetaT in m: formula (10) of 5.3.4.1, 0.05 sqrt d + 0.35 sqrt b + 4 um of class 5, d and b in mm."""
    diameter, width = 2e3 * gear.reference_radius, 1e3 * gear.face_width
    own = 0.05 * math.sqrt(diameter) + 0.35 * math.sqrt(width) + 4.0
    return 1e-6 * _rounded(own * _step(tolerance_class))


def _rounded(tolerance: float) -> float:
    """Round a tolerance in um: above 10 to whole ones, from 5 to halves, below to tenths (5.2.3)."""
    parts = 1 if tolerance > 10.0 else 2 if tolerance >= 5.0 else 10
    return math.floor(tolerance * parts + 0.5) / parts


def _step(tolerance_class: int) -> float:
    """Tolerance of a class over that of class 5, which is not rounded before (5.2.2)."""
    return math.sqrt(2.0) ** (tolerance_class - 5)


def _check_scope(name: str, gear: Toothing) -> None:
    """Refuse a gear for which the formulas are not made (clause 1)."""
    for figure, value, low, high in (
        ("teeth", gear.teeth, 5, 1000),
        ("normal_module", gear.normal_module, 0.5e-3, 70e-3),
        ("reference_diameter", 2.0 * gear.reference_radius, 5e-3, 15.0),
        ("face_width", gear.face_width, 4e-3, 1.2),
        ("helix_angle", abs(gear.helix_angle), 0.0, math.radians(45.0)),
    ):
        within(f"{name}.{figure}", value, low, high, _ADVICE)
