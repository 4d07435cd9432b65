"""Tolerances of assembly and manufacture: how figures are distributed between the limits of inspection."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from scipy.special import ndtr, ndtri

from bounds import SiNote
from fe_contact.checks import positive
from fe_contact.errors import InputError
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.microgeometry.variables import gear_and_quantity
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
