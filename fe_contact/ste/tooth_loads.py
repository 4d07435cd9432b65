"""Loads of each tooth of a gear, from a table over the pitches in which its teeth mesh in turn.

Pair j in whole pitch p is meeting p - j: the pair of teeth that touches at the pitch point at position p - j.
The teeth of a gear of z teeth have loads of their own where the period is a multiple of z.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.ste.curve import at_operating_point
from fe_contact.ste.fields import SteFields
from fe_contact.ste.operating_point import OperatingPoint
from fe_contact.types import FloatArray, IntArray

_ALIKE = 5e-4
"""Difference of loads over the largest load below which teeth count as alike. Three decimals do not show it.
"""
_SAME = 1e-9
"""Distance of two phases below which they are equal, base pitches."""


@dataclass(frozen=True, eq=False)
class ToothLoads:
    """Largest loads on each tooth of a gear at one load and alignment, over all its mates."""

    gear: int
    """Number of the gear: 0 is the driving gear, 1 the driven one."""
    phase: FloatArray
    """Phase of the pair on its way through mesh, base pitches; 0: at the pitch point in mid-face. Shape (W,).
    """
    force_over_phase: FloatArray
    """Normal force on each tooth at each phase, N; teeth in the order of meshing, tooth 1 first. NaN: not
    stored. Shape (z, W).
    """
    pressure_over_phase: FloatArray
    """Largest contact pressure away from edges, Pa; (z, 0) of tables without `pair_pressure`. Shape (z, W).
    """

    @property
    def force(self) -> FloatArray:
        """Largest normal force on each tooth, (z,) in N."""
        return np.asarray(np.fmax.reduce(self.force_over_phase, axis=1))

    @property
    def pressure(self) -> FloatArray:
        """Largest contact pressure on each tooth, (z,) in Pa; NaN where it is not stored."""
        return np.asarray(np.fmax.reduce(self.pressure_over_phase, axis=1, initial=np.nan))

    @property
    def most_loaded(self) -> tuple[int, ...]:
        """Numbers of the teeth of the largest force, from 1; none where all teeth carry as much at most."""
        return _worst(self.force)

    @property
    def over_mean(self) -> float:
        """Largest force on a most loaded tooth over the mean of all teeth."""
        return float(self.force.max() / self.force.mean())

    @property
    def most_pressed(self) -> tuple[int, ...]:
        """Numbers of the teeth of the largest pressure; none where all are alike or it is not stored."""
        return _worst(self.pressure)


def tooth_loads(table: SteFields, point: OperatingPoint) -> tuple[ToothLoads, ...]:
    """Return the loads of the teeth of each gear whose teeth the table tells apart, and which differ."""
    gears = [gear for gear in (0, 1) if table.period % table.geometry.teeth[gear] == 0]
    if not gears:
        return ()
    share = np.maximum(at_operating_point(table, table.load_share, point), 0.0)
    values = [point.force * share / share.sum(axis=1, keepdims=True)]
    if table.pair_pressure.size:
        values.append(np.maximum(at_operating_point(table, table.pair_pressure, point), 0.0))
    loads_of_gears = [_of_gear(table, values, gear) for gear in gears]
    return tuple(loads for loads in loads_of_gears if loads.most_loaded or loads.most_pressed)


def _worst(largest: FloatArray) -> tuple[int, ...]:
    """Return the teeth of the largest value; none where that is no more than the mean."""
    worst = np.flatnonzero(largest >= (1.0 - _ALIKE) * largest.max())
    return tuple(int(k) + 1 for k in worst) if largest.max() > (1.0 + _ALIKE) * largest.mean() else ()


def _of_gear(table: SteFields, values: list[FloatArray], gear: int) -> ToothLoads:
    """Take the largest of forces, and of pressures if there are any (P, N), by tooth and phase."""
    pitch, teeth = np.floor(table.position).astype(np.int64), table.geometry.teeth[gear]
    node, nodes = _nodes(table.position - pitch)
    tooth = (pitch[:, None] - table.pair) % teeth
    way = np.arange(table.pair.size) * nodes.size + node[:, None]
    largest = [np.full((teeth, table.pair.size * nodes.size), np.nan) for _ in values]
    for maximum, samples in zip(largest, values, strict=True):
        np.fmax.at(maximum, (tooth, way), samples)
    force, pressure = (*largest, np.empty((teeth, 0)))[:2]
    return ToothLoads(gear, (table.pair[:, None] + nodes).ravel(), force, pressure)


def _nodes(fraction: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the number (P,) of each fraction of a pitch among those that differ, and these (n,)."""
    order = np.argsort(fraction, kind="stable")
    further = np.concatenate([[False], np.diff(fraction[order]) > _SAME])
    number = np.empty(fraction.size, dtype=np.int64)
    number[order] = np.cumsum(further)
    return number, fraction[order][np.concatenate([[True], further[1:]])]
