"""Loads of each tooth, from a table over the pitches in which the teeth of a gear meet in turn.

Pair j in whole pitch p is meeting p - j: the pair of teeth that touches at the pitch point at position p - j.
The teeth of a gear of z teeth are told apart where the period is a multiple of z.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.ste.curve import OperatingPoint, at_operating_point
from fe_contact.ste.fields import SteFields
from fe_contact.types import FloatArray, IntArray

_ALIKE = 1e-6
"""Of the largest load: teeth that differ by less are alike."""
_SAME = 1e-9
"""Base pitches between two phases that are one."""


@dataclass(frozen=True, eq=False)
class ToothLoads:
    """Largest loads on each tooth of a gear at one load and alignment, over all its mates.

    Attributes
    ----------
    gear : int
        0: the driving gear, 1: the driven one.
    phase : (W,) array
        Where the pair is on its way through mesh, base pitches; 0: at the pitch point in mid-face.
    over_phase : (z, W) array
        Normal force on each tooth there, N; teeth in the order of meshing, tooth 1 first. NaN: not stored.
    """

    gear: int
    phase: FloatArray
    over_phase: FloatArray

    @property
    def force(self) -> FloatArray:
        """Largest normal force on each tooth, (z,) in N."""
        return np.asarray(np.fmax.reduce(self.over_phase, axis=1))

    @property
    def worst(self) -> int:
        """Number of the most loaded tooth, from 1 in the order of meshing."""
        return int(np.argmax(self.force)) + 1

    @property
    def over_mean(self) -> float:
        """Largest force on the most loaded tooth over the mean of all teeth."""
        return float(self.force.max() / self.force.mean())


def tooth_loads(table: SteFields, point: OperatingPoint) -> tuple[ToothLoads, ...]:
    """Return the loads of the teeth of each gear whose teeth the table tells apart, and which differ."""
    share = np.maximum(at_operating_point(table, table.load_share, point), 0.0)
    force = point.force * share / share.sum(axis=1, keepdims=True)
    found = (_of_gear(table, force, gear) for gear in (0, 1) if table.period % table.facts.teeth[gear] == 0)
    return tuple(loads for loads in found if np.ptp(loads.force) > _ALIKE * loads.force.max())


def _of_gear(table: SteFields, values: FloatArray, gear: int) -> ToothLoads:
    """Take the largest of values (P, N) by tooth and phase."""
    pitch = np.floor(table.position).astype(np.int64)
    node, nodes = _nodes(table.position - pitch)
    tooth = (pitch[:, None] - table.pair) % table.facts.teeth[gear]
    way = np.arange(table.pair.size) * nodes.size + node[:, None]
    largest = np.full((table.facts.teeth[gear], table.pair.size * nodes.size), np.nan)
    np.fmax.at(largest, (tooth, way), values)
    return ToothLoads(gear, (table.pair[:, None] + nodes).ravel(), largest)


def _nodes(fraction: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the number (P,) of each fraction of a pitch among those that differ, and these (n,)."""
    order = np.argsort(fraction, kind="stable")
    further = np.concatenate([[False], np.diff(fraction[order]) > _SAME])
    number = np.empty(fraction.size, dtype=np.int64)
    number[order] = np.cumsum(further)
    return number, fraction[order][np.concatenate([[True], further[1:]])]
