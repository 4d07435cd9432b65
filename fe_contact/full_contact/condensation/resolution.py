"""Resolution of the contact and of the bodies behind it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fe_contact.checks import integer, within

GROWTH = 1.08
"""Growth of the elements per unit distance, over the elements per half-width: 0.18 at six."""
INNER_GROWTH = 1.2
USUAL = 6.0
COARSEST = 1.25


@dataclass(frozen=True)
class Resolution:
    """Element sizes of a resolved contact; everything is refined in proportion.

    Attributes
    ----------
    per_half_width : float
        Quadratic elements in a Hertz half-width, 1.5 to 16.
    corner : float
        How many times finer the elements at a tip edge are.
    layers : int
        Layers over half the face, 1 to 24; the plane has none.
    """

    per_half_width: float = USUAL
    corner: float = 8.0
    layers: int = 6

    def __post_init__(self) -> None:
        within("per_half_width", self.per_half_width, 1.5, 16.0, "6 is usual.")
        within("corner", self.corner, 1.0, 32.0, "8 is usual.")
        integer("layers", self.layers, 1, 24)

    @property
    def growth(self) -> float:
        """Growth of the elements per unit distance from the contacts."""
        return GROWTH / self.per_half_width

    @property
    def inner_growth(self) -> float:
        """Growth from the boundary inwards."""
        return min(0.3, INNER_GROWTH / self.per_half_width)

    def edge_size(self, least: float, largest: float) -> float:
        """Return the size at a tip edge, m, from the half-widths of least and largest load."""
        return math.sqrt(least * largest) / (self.corner * self.per_half_width)

    def part(self, share: float, module: float) -> float:
        """Return a size away from the contacts, m: a share of the module on the usual mesh."""
        return share * module * min(USUAL / self.per_half_width, COARSEST)

    def coarser(self, factor: float = 1.5) -> Resolution:
        """Return the same with elements larger by `factor`."""
        return Resolution(self.per_half_width / factor, self.corner, max(1, round(self.layers / factor)))
