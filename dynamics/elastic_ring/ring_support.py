"""Support of a ring over its angle: lugs or bolts at angles, and a spline or press fit all around."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.elastic_ring.annulus import Annulus
from dynamics.errors import InputError
from dynamics.types import FloatArray

MAX_LUGS = 120
"""Most lugs: their spacing is resolved four times by the harmonics of modes."""


@dataclass(frozen=True)
class RingSupport:
    """Springs between the outer surface of a ring and the housing, which is rigid.

    Raises `InputError`: a negative stiffness, more lugs than `MAX_LUGS`.
    """

    lugs: int = 0
    """Number of lugs or bolts, spaced equally."""
    first_lug: float = 0.0
    """Angle of the first lug, rad."""
    lug_radial: float = 0.0
    """Radial stiffness of each lug, N/m."""
    lug_tangential: float = 0.0
    """Tangential stiffness of each lug, N/m."""
    fit_radial: float = 0.0
    """Radial stiffness of a spline or press fit, in all, N/m: force of all around per radial expansion."""
    fit_tangential: float = 0.0
    """Tangential stiffness of a spline or press fit, in all, N/m."""

    def __post_init__(self) -> None:
        if not 0 <= self.lugs <= MAX_LUGS:
            raise InputError("lugs", self.lugs, f"0 to {MAX_LUGS}", "State more of them as a press fit.")
        for name in ("lug_radial", "lug_tangential", "fit_radial", "fit_tangential"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise InputError(name, value, ">= 0 N/m", "0 leaves a direction free.")

    @property
    def angles(self) -> FloatArray:
        """Angles of the lugs, (lugs,), rad."""
        return self.first_lug + 2.0 * np.pi * np.arange(self.lugs) / max(self.lugs, 1)

    def distributed(self, ring: Annulus) -> FloatArray:
        """Return the stiffness of spline or press fit of any harmonic per radian, (3, 3)."""
        radial = ring.motion(ring.outer_radius, 1.0, 0.0)
        tangential = ring.motion(ring.outer_radius, 0.0, 1.0)
        parts = (self.fit_radial, radial), (self.fit_tangential, tangential)
        around = sum(stiffness * np.outer(motion.conj(), motion).real for stiffness, motion in parts)
        return np.asarray(around / (2.0 * np.pi))
