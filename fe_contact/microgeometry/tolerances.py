"""Tolerances of assembly and manufacture: how deviations are distributed between the limits of inspection."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from bounds import SiNote
from fe_contact.errors import InputError, integer, positive
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.geometry.flank_tolerances import (
    check_scope,
    helix_form_tolerance,
    helix_slope_tolerance,
    profile_form_tolerance,
    profile_slope_tolerance,
)
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.microgeometry.variables import ACROSS_FACE, GEARS, gear_and_quantity
from fe_contact.types import FloatArray, Json
from host.optional_modules import special

Distribution = Literal["normal", "uniform"]
PROCESS_SPREAD = 3.0
"""Half width of a tolerance in standard deviations of the normal distribution, which is cut there."""

Finishing = Literal["any", "generating_grinding", "form_grinding", "honing", "shaving", "hobbing"]
OF_A_CLASS = {
    "profile_slope": profile_slope_tolerance,
    "profile_form": profile_form_tolerance,
    "helix_slope": helix_slope_tolerance,
    "helix_form": helix_form_tolerance,
}
"""Tolerances that bound the mean flank of a gear."""
COMMON: Mapping[Finishing, tuple[float, float, float, float]] = {
    "any": (1.0, 1.0, 1.0, 1.0),
    "generating_grinding": (0.8, 0.9, 0.7, 0.9),
    "form_grinding": (0.9, 0.9, 0.7, 0.9),
    "honing": (0.7, 0.8, 0.6, 0.8),
    "shaving": (0.7, 0.8, 0.6, 0.7),
    "hobbing": (0.6, 0.7, 0.5, 0.6),
}
"""Assumed part of each tolerance of `OF_A_CLASS`, in this order, that the mean tooth takes, by finishing.

With the part c two teeth of a gear correlate by c^2. The rest differs from tooth to tooth: it excites orders
of shafts and sidebands, not mesh orders. A dressed wheel or worm makes the profile, so that teeth are alike;
run-out of the blank changes the helix slope once a revolution; a hob cuts each flank separately. The parts
are not measured.
"""
ACCUMULATED: Mapping[Finishing, float] = {
    "any": 0.0,
    "generating_grinding": 0.3,
    "form_grinding": 0.1,
    "honing": 0.4,
    "shaving": 0.4,
    "hobbing": 0.3,
}
"""Assumed share of the accumulated deviation in the square of a single pitch deviation, by finishing.

Where tool and gear roll, errors of the table and of the blank vary slowly over the teeth, and smoothing of
neighbors leaves them. Where each gap is ground by itself, indexing places each tooth independently. The
shares are not measured.
"""


@dataclass(frozen=True)
class Tolerances:
    """Half widths of tolerance bands about the design, and the distribution within them."""

    misalignment: float = 0.0
    """Half width of the misalignment, m, >= 0."""
    modification: Mapping[str, float] = field(default_factory=dict)
    """``gear.quantity`` to the half width of its deviation, m, > 0."""
    distribution: Distribution = "normal"
    """Normal: three standard deviations are the tolerance, and deviations beyond are rejected."""

    def __post_init__(self) -> None:
        if self.misalignment:
            positive("tolerances.misalignment", self.misalignment, SiNote("In m: 10 µm is 1e-5."))
        for name, width in self.modification.items():
            gear_and_quantity(f"tolerances.modification.{name}", name)
            positive(f"tolerances.modification.{name}", width, SiNote("In m: 10 µm is 1e-5."))
        if self.distribution not in ("normal", "uniform"):
            raise InputError("tolerances.distribution", self.distribution, 'one of "normal" and "uniform"')
        if not self.widths:
            raise InputError("tolerances", {}, "at least one width above 0")

    @property
    def widths(self) -> dict[str, float]:
        """Half width of every deviation, m, in a fixed order."""
        misaligned = {MISALIGNMENT: self.misalignment} if self.misalignment else {}
        return misaligned | dict(sorted(self.modification.items()))

    def sample(self, count: int, seed: int) -> FloatArray:
        """Draw deviations (count, d) in m from a scrambled Sobol' sequence.

        A larger sample of the same seed begins with a smaller one.
        """
        from scipy.stats import qmc  # noqa: PLC0415 (start-up time)

        widths = np.array(list(self.widths.values()))
        sequence = qmc.Sobol(widths.size, rng=seed)
        uniform = sequence.random_base2(max(count - 1, 1).bit_length())[:count]
        return spread_within(widths, uniform, self.distribution)

    @property
    def distributions(self) -> tuple[Any, ...]:
        """Distribution of every deviation, in the order of `widths`, as a frozen one of scipy."""
        from scipy.stats import truncnorm, uniform  # noqa: PLC0415 (start-up time)

        widths = self.widths.values()
        if self.distribution == "uniform":
            return tuple(uniform(-width, 2.0 * width) for width in widths)
        ends = -PROCESS_SPREAD, PROCESS_SPREAD
        return tuple(truncnorm(*ends, scale=width / PROCESS_SPREAD) for width in widths)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "misalignment_m": self.misalignment,
            "modification_m": dict(self.modification),
            "distribution": self.distribution,
        }


def spread_within(width: float | FloatArray, uniform: FloatArray, distribution: Distribution) -> FloatArray:
    """Return deviations, m, within half widths, m, from uniform numbers between 0 and 1."""
    if distribution == "uniform":
        return np.asarray(width * (2.0 * uniform - 1.0))
    low = special.ndtr(-PROCESS_SPREAD)
    return np.asarray(width * special.ndtri(low + (1.0 - 2.0 * low) * uniform) / PROCESS_SPREAD)


def iso1328_tolerances(
    pair: ParallelAxes,
    tolerance_class: int,
    *,
    misalignment: float = 0.0,
    across_face: bool = True,
    distribution: Distribution = "normal",
    finishing: Finishing = "any",
) -> Tolerances:
    """Return tolerances of slope and form of profile and helix of both gears by ISO 1328-1:2013.

    Raises `InputError`: no such class, or a gear beyond the range of the standard.

    Parameters
    ----------
    tolerance_class : int
        1 (finest) to 11.
    misalignment : float
        Half width of the misalignment by assembly, m; the standard has none.
    across_face : bool
        Whether helices deviate too, which a plane model cannot represent.
    finishing : str
        Finishing of the flanks, a key of `COMMON`.
    """
    integer("tolerance_class", tolerance_class, 1, 11)
    widths = {}
    for name in GEARS:
        gear: Toothing = getattr(pair, name)
        check_scope(name, gear)
        for (quantity, tolerance), part in zip(OF_A_CLASS.items(), COMMON[finishing], strict=True):
            if across_face or quantity not in ACROSS_FACE:
                widths[f"{name}.{quantity}"] = part * tolerance(gear, tolerance_class)
    return Tolerances(misalignment, widths, distribution)
