"""Weak gap of one tooth pair by segment integration: linear hats of pressure on the slave, no penalty.

Hats phi_i stand on the nodes of the slave's elements, the mid-side ones too. With the outward normal n of the
slave, the gap g along it to the master and the points x_s, x_m that face each other,

    G_i = integral of phi_i g,   forces of hat i: -phi_i n on the slave, +phi_i n on the master,

so that what these forces do to the displacements is dG_i: action is reaction, and the compliance symmetric.
Segments end at the hats, at the corners of the mate's elements, and at the master's tip edge, beyond which
nothing touches.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fe_contact.types import FloatArray
from verification.full_contact.condensation.flank_curve import CurvePoints, FlankCurve

_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
Velocity = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class WeakGap:
    """Weak gap of one pair in one configuration; h hats."""

    gap: FloatArray
    """G_i, m^2. Shape (h,)."""
    weight: FloatArray
    """Integral of phi_i over the part that faces the master, m. Shape (h,)."""
    closing: FloatArray
    """-dG_i by the lag of the driven gear, m. Shape (h,)."""
    forces: tuple[FloatArray, FloatArray]
    """Nodal forces on the strips of gear 1 and gear 2 by unit pressures, m. ((2 k_1, h), (2 k_2, h)) arrays.
    """


class _Facing(NamedTuple):
    """Quadrature points of the slave (q,) and opposite points; normals (q, 2), hats (q, h), lengths (q,)."""

    slave: CurvePoints
    master: CurvePoints
    normals: FloatArray
    hats: FloatArray
    lengths: FloatArray


def weak_gap(
    curves: tuple[FlankCurve, FlankCurve], reference: FlankCurve, slave: int, lag: Velocity
) -> WeakGap:
    """Integrate the gap of one pair.

    Parameters
    ----------
    curves : (FlankCurve, FlankCurve)
        Strips of gear 1 and gear 2 in the configuration.
    reference : FlankCurve
        The slave's strip before it is deformed, whose normals are those of the gap and of the pressure:
        under a tip edge the deformed flank has a kink and no normal.
    slave : int
        0 or 1: the gear whose strip carries the hats.
    lag : callable
        Velocities (q, 2) of gear 2's points (q, 2) by the lag, m per m.
    """
    facing = _facing(curves[slave], curves[1 - slave], reference)
    normal = facing.normals
    weighted = facing.hats * facing.lengths[:, None]
    distance = np.einsum("qx,qx->q", facing.master.at - facing.slave.at, normal)
    driven = facing.master if slave == 0 else facing.slave
    rate = np.einsum("qx,qx->q", lag(driven.at), normal) * (1.0 if slave == 0 else -1.0)
    on_slave = _nodal(facing.slave, -normal, weighted, len(curves[slave].nodes))
    on_master = _nodal(facing.master, normal, weighted, len(curves[1 - slave].nodes))
    return WeakGap(
        gap=weighted.T @ distance,
        weight=weighted.sum(axis=0),
        closing=-weighted.T @ rate,
        forces=(on_slave, on_master) if slave == 0 else (on_master, on_slave),
    )


def _facing(slave: FlankCurve, master: FlankCurve, reference: FlankCurve) -> _Facing:
    """Return the quadrature points of all segments."""
    feet = slave.foot_of(master.nodes[::2], reference)
    low, high = np.clip([feet.min(), feet.max()], 0.0, slave.pieces)
    breaks = np.concatenate([0.5 * np.arange(2 * slave.pieces + 1.0), feet])
    breaks = np.unique(np.clip(breaks, low, high))
    middle, half = 0.5 * (breaks[1:] + breaks[:-1]), 0.5 * np.diff(breaks)
    t = (middle[:, None] + half[:, None] * _GAUSS).ravel()
    weights = (half[:, None] * _WEIGHTS).ravel()
    points = slave.points(t)
    met = master.met_along(points.at, reference.points(t).tangents)
    hit = np.isfinite(met)
    points, t, weights = slave.points(t[hit]), t[hit], weights[hit]
    undeformed = reference.points(t)
    lengths = weights * np.linalg.norm(undeformed.slope, axis=1)
    nodes = 0.5 * np.arange(2 * slave.pieces + 1.0)
    hats = np.maximum(1.0 - 2.0 * np.abs(t[:, None] - nodes), 0.0)
    return _Facing(points, master.points(met[hit]), undeformed.normals, hats, lengths)


def _nodal(points: CurvePoints, direction: FloatArray, weighted: FloatArray, count: int) -> FloatArray:
    """Return the consistent nodal forces (2 count, h) of unit pressures along a direction."""
    shape = np.zeros((len(points.at), count))
    np.put_along_axis(shape, points.nodes, points.weights, axis=1)
    forces = np.empty((2 * count, weighted.shape[1]))
    for component in range(2):
        forces[component::2] = shape.T @ (weighted * direction[:, component : component + 1])
    return forces
