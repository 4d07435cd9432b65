"""Resolution of a contact and of the bodies behind it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fe_contact.errors import integer, within

GROWTH = 1.08
"""Growth of the elements per unit distance, over the elements per half-width: 0.18 at six."""


INNER_GROWTH = 1.2


USUAL = 6.0


COARSEST = 1.25


@dataclass(frozen=True)
class Resolution:
    """Element sizes of a resolved contact; everything is refined in proportion."""

    per_half_width: float = USUAL
    """Quadratic elements in a Hertz half-width, 1.5 to 16."""
    corner: float = 8.0
    """Usual element size over the element size at a tip edge."""
    layers: int = 6
    """Layers over half the face, 1 to 24; the plane has none."""
    outermost: float = 0.25
    """Thickness of the layer at the face over that at mid-face, 0.01 to 1: 0.05 resolves the free ends."""

    def __post_init__(self) -> None:
        within("per_half_width", self.per_half_width, 1.5, 16.0, "6 is usual.")
        within("corner", self.corner, 1.0, 32.0, "8 is usual.")
        integer("layers", self.layers, 1, 24)
        within("outermost", self.outermost, 0.01, 1.0, "0.25 is usual.")

    @property
    def growth(self) -> float:
        """Growth of the elements per unit distance from the contacts."""
        return GROWTH / self.per_half_width

    @property
    def inner_growth(self) -> float:
        """Growth from the boundary inwards."""
        return min(0.3, INNER_GROWTH / self.per_half_width)

    def edge_size(self, minimum: float, largest: float) -> float:
        """Return the size at a tip edge, m, from the half-widths of least and largest load."""
        return math.sqrt(minimum * largest) / (self.corner * self.per_half_width)

    def part(self, share: float, module: float) -> float:
        """Return a size away from the contacts, m: a share of the module on the usual mesh."""
        return share * module * min(USUAL / self.per_half_width, COARSEST)

    def coarser(self, factor: float = 1.5) -> Resolution:
        """Return the resolution with elements larger by `factor`."""
        layers = max(1, round(self.layers / factor))
        return Resolution(self.per_half_width / factor, self.corner, layers, self.outermost)
