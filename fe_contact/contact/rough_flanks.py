"""Bounds of the roughness of flanks: surfaces on all teeth of a gear, and gaps of single teeth."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from fe_contact.contact.model import MeetingTeeth, ToothGap
from fe_contact.flank.extent import Extent
from fe_contact.geometry import FlankGrid, ParallelAxes
from fe_contact.geometry.tooth_surfaces import profile_nodes
from fe_contact.types import FloatArray, IntArray


class DesignedSurface(NamedTuple):
    """Extent and nodes of a surface on all teeth of a gear; see `ToothSurfaces`."""

    gear: int
    extent: Extent
    nodes: FloatArray

    @classmethod
    def of(cls, pair: ParallelAxes, gear: int, grid: FlankGrid) -> DesignedSurface:
        """Return the extent of a surface of the pinion, gear 0, or the wheel."""
        toothing = (pair.pinion, pair.wheel)[gear]
        ends = toothing.form_roll_length, toothing.tip_roll_length
        return cls(gear, grid.extent(ends), profile_nodes(ends, 0.0, grid))


class DeviatingTeeth(NamedTuple):
    """Gaps that differ from tooth to tooth, and which pair of teeth meets at each candidate."""

    gaps: tuple[ToothGap, ...]
    meeting: IntArray

    def gap(self, pair: ParallelAxes, rolls: tuple[FloatArray, FloatArray], face: FloatArray) -> FloatArray:
        """Return the sum of the gaps at roll lengths of both gears, m."""
        teeth = MeetingTeeth(pair, self.meeting, *rolls, face)
        return np.asarray(sum((term(teeth) for term in self.gaps), np.zeros(())))

    def extents(self) -> list[tuple[int, Extent]]:
        """Return the gear of each gap, and its extent on the teeth that meet."""
        return [(term.gear, term.extents.at(term.tooth(self.meeting))) for term in self.gaps]

    def nodes(self, pair: ParallelAxes) -> list[tuple[int, list[FloatArray], IntArray]]:
        """Return the gear of each gap, the nodes of its teeth, and which of these teeth meets.

        Nodes are roll lengths in m, one array a tooth.
        """
        sets = []
        for term in self.gaps:
            teeth = term.tooth(self.meeting)
            numbers = np.flatnonzero(np.bincount(teeth))
            lists = [term.nodes(pair, int(tooth)) for tooth in numbers]
            sets.append((term.gear, lists, np.searchsorted(numbers, teeth)))
        return sets

    def rows(self, keep: IntArray | slice) -> DeviatingTeeth:
        """Return the gaps at some of the candidates."""
        return self._replace(meeting=self.meeting[keep])


def curvature_bound(
    pair: ParallelAxes, extents: Iterable[tuple[int, Extent]], rolls: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Return a bound of the curvature along flanks by gaps of both gears at roll lengths of both, 1/m."""
    gears = pair.pinion, pair.wheel
    bounds = (extent.curvature(gears[gear].base_radius, gear, rolls) for gear, extent in extents)
    return np.asarray(sum(bounds, np.zeros(rolls[0].shape)))
