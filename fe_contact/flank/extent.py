"""Extent of a gap between flanks: how far it opens and closes at most, and how fast it changes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fe_contact.types import FloatArray, IntArray

if TYPE_CHECKING:
    from fe_contact.flank.flank_grid import FlankGrid
    from fe_contact.flank.modification import FlankModification
    from fe_contact.flank.part import FlankPart, ReliefStart, Tooth

_ALONG_PROFILE, _ALONG_FACE = 65, 33
"""Points of the lattice, ends and middles among them, over which the parts of a modification are smooth."""
_BETWEEN = 0.25
"""A smooth course leaves its lattice by an eighth of the second difference, a kinked one by twice that."""


@dataclass(frozen=True)
class Extent:
    """Bounds of a gap; floats, or arrays that broadcast.

    Attributes
    ----------
    low, high : float or ndarray
        Bounds from below and above, m.
    slope : float or ndarray
        Bound of its change per way along the line of action, m/m.
    """

    low: FloatArray | float = 0.0
    high: FloatArray | float = 0.0
    slope: FloatArray | float = 0.0

    def __add__(self, other: Extent) -> Extent:
        """Return the extent of the sum of two gaps."""
        return Extent(self.low + other.low, self.high + other.high, self.slope + other.slope)

    @property
    def reach(self) -> float:
        """Bound of the size of the gap, m."""
        return float(max(np.max(self.high), -np.min(self.low), 0.0))

    @property
    def span(self) -> float:
        """Bound of the difference between any two places, m."""
        return float(max(np.max(self.high), 0.0) - min(np.min(self.low), 0.0))

    def at(self, index: IntArray) -> Extent:
        """Return the extents at indices into its arrays."""
        low, high, slope = (np.asarray(values)[index] for values in (self.low, self.high, self.slope))
        return Extent(low, high, slope)


def modification_extent(modification: FlankModification, gear: Tooth, tip_form: float) -> Extent:
    """Return the extent of the material that a modification removes from the usable flank of a gear.

    Parts count one by one, as if all of them were deepest at one place.

    Parameters
    ----------
    tip_form : float
        Roll length at which the usable flank ends, m.
    """
    extents = (
        _part_extent(part, gear, tip_form)
        for part in modification.parts
        if part.varies and not any(start.ends_flank for start in part.relief_starts(gear))
    )
    extent = sum(extents, Extent())
    return replace(extent, low=max(extent.low, 0.0)) if modification.only_removes else extent


def _part_extent(part: FlankPart, gear: Tooth, tip_form: float) -> Extent:
    """Bound a part by its values on a lattice, and by what it can do between the points."""
    grid: FlankGrid | None = getattr(part, "flank_grid", None)
    if grid is not None:
        return grid.extent
    roll = np.linspace(gear.form_roll_length, tip_form, _ALONG_PROFILE)
    face = np.linspace(-0.5, 0.5, _ALONG_FACE) * gear.face_width
    removed = part.removed(gear, *np.meshgrid(roll, face, indexing="ij"))
    bends = (np.abs(np.diff(removed, 2, axis=axis)).max() for axis in (0, 1))
    between = _BETWEEN * float(sum(bends))
    secant = np.abs(np.diff(removed, axis=0)).max() / abs(roll[1] - roll[0])
    begin = max((_start_slope(start, gear) for start in part.relief_starts(gear, 0.0)), default=0.0)
    bend = np.abs(np.diff(removed, 2, axis=0)).max() / abs(roll[1] - roll[0])
    low, high = float(removed.min()) - between, float(removed.max()) + between
    return Extent(low, high, max(float(secant + bend), begin))


def _start_slope(start: ReliefStart, gear: Tooth) -> float:
    """Return the slope with which a relief begins over the roll length."""
    return float(np.max(np.abs(start.jump)) * np.max(start.roll_length) / gear.base_radius)
