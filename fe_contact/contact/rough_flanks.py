"""How rough flanks may be: surfaces on all teeth of a gear, and what differs from tooth to tooth."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fe_contact.contact.model import MeetingTeeth, ToothGap
from fe_contact.geometry import FlankGrid, ParallelAxes
from fe_contact.geometry.tooth_surfaces import curvature_bound, grid_figures, profile_nodes
from fe_contact.types import FloatArray, IntArray


class DesignedSurface(NamedTuple):
    """How rough a surface on all teeth of a gear is; see `ToothSurfaces`."""

    gear: int
    kink: float
    curvature: float
    spread: float
    nodes: FloatArray

    @classmethod
    def of(cls, pair: ParallelAxes, gear: int, grid: FlankGrid) -> DesignedSurface:
        """Return that of a surface of the pinion, gear 0, or the wheel."""
        toothing = (pair.pinion, pair.wheel)[gear]
        ends = toothing.form_roll_length, toothing.tip_roll_length
        return cls(gear, *grid_figures(grid, ends), profile_nodes(ends, 0.0, grid))

    def bend(self, pair: ParallelAxes, rolls: tuple[FloatArray, FloatArray]) -> FloatArray:
        """Return a bound of its curvature along the flanks at roll lengths of both gears, 1/m."""
        base_radius = (pair.pinion, pair.wheel)[self.gear].base_radius
        return curvature_bound(base_radius / rolls[self.gear], rolls, self.kink, self.curvature)


class DeviatingTeeth(NamedTuple):
    """Gaps that differ from tooth to tooth, and which pair of teeth meets at each candidate."""

    gaps: tuple[ToothGap, ...]
    meeting: IntArray

    def gap(self, pair: ParallelAxes, rolls: tuple[FloatArray, FloatArray], face: FloatArray) -> FloatArray:
        """Return their sum at roll lengths of both gears, m."""
        there = MeetingTeeth(pair, self.meeting, *rolls, face)
        return np.asarray(sum((term(there) for term in self.gaps), np.zeros(())))

    def bend(self, pair: ParallelAxes, rolls: tuple[FloatArray, FloatArray], face: FloatArray) -> FloatArray:
        """Return a bound of their curvature along the flanks, 1/m."""
        there = MeetingTeeth(pair, self.meeting, *rolls, face)
        return np.asarray(sum((term.bend(there) for term in self.gaps), np.zeros(())))

    @property
    def spread(self) -> FloatArray:
        """Bound of highest less lowest gap along the profiles, m."""
        return np.asarray(sum((term.spread(self.meeting) for term in self.gaps), np.zeros(())))

    def nodes(self, pair: ParallelAxes) -> list[tuple[int, list[FloatArray], IntArray]]:
        """Return of each gap its gear, nodes of its teeth as roll lengths in m, and which tooth meets."""
        sets = []
        for term in self.gaps:
            teeth = term.tooth(self.meeting)
            numbers = np.flatnonzero(np.bincount(teeth))
            lists = [term.nodes(pair, int(tooth)) for tooth in numbers]
            sets.append((term.gear, lists, np.searchsorted(numbers, teeth)))
        return sets

    def some(self, of: IntArray | slice) -> DeviatingTeeth:
        """Return those of some of the candidates."""
        return self._replace(meeting=self.meeting[of])
