"""The elastic housing of the scene: the reduced stiffness matrix of the casing's assembly group."""

from __future__ import annotations

from typing import Any

import numpy as np

from bounds.types import FloatArray
from dynamics.bearings.matrix import least_share
from dynamics.joints.housing import DEFINITE
from lineofaction.gearbox.from_rexs.gear_unit import Names, Part
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.placement import FIXED, placement

_MATRIX = "reduced_static_stiffness_matrix"
_PER_POINT = 6
SYMMETRIC = 1e-6
"""Relative; a finite-element program writes its matrices with that many digits."""


def scene_housings(layout: Layout, seats: dict[int, str]) -> list[dict[str, Any]]:
    """Return the housings whose points carry bearings.

    The matrix of the file has six rows a point, motions along and rotations about u, v, w of its assembly
    group, in N, mm, rad, and the order of the points. Points that carry no bearing of the scene follow free
    of force (static condensation). `seats` has the names of the bushings by component.
    """
    names = Names()
    tables = (_housing(layout, group, seats, names) for group in _groups(layout))
    return [table for table in tables if table is not None]


def loosely_housed(layout: Layout) -> set[int]:
    """Return the components in an elastic housing that is not held in all directions: its matrix is singular.

    Only linear bearings sit in such a housing.
    """
    loose: set[int] = set()
    for group in _groups(layout):
        points = group.children("reduction_point")
        matrix = _stiffness(group, len(points))
        if matrix is not None and least_share(matrix) <= DEFINITE:
            seats = (point.referenced for point in points)
            loose |= {part.id for parts in seats for part in parts}
    return loose


def _groups(layout: Layout) -> list[Part]:
    return [
        group
        for casing in layout.unit.of_type("gear_casing")
        for group in casing.referenced
        if group.type == "assembly_group"
    ]


def _housing(layout: Layout, group: Part, seats: dict[int, str], names: Names) -> dict[str, Any] | None:
    """Return a housing, None if the account says why there is none."""
    points = group.children("reduction_point")
    bearings = [_bushing(layout, point, seats) for point in points]
    matrix = _stiffness(group, len(points))
    if matrix is None:
        return None
    if not any(bearings):
        group.say("", "refused", "no reduction point refers to a bearing of the scene")
        return None
    place = placement(group) or FIXED
    turn = np.kron(np.eye(2 * len(points)), layout.axes.turn(place))
    turned = turn @ matrix @ turn.T
    kept = [index for index, name in enumerate(bearings) if name]
    group.say("", "taken", "elastic housing")
    group.say(_MATRIX, "taken", f"stiffness under {len(kept)} bearings; u, v, w turned to x, y, z, mm to m")
    return {
        "name": names.of(group),
        "bushings": [name for name in bearings if name],
        "stiffness_matrix": _condensed(turned, kept).tolist(),
    }


def _bushing(layout: Layout, point: Part, seats: dict[int, str]) -> str | None:
    for part in point.referenced:
        if part.id in seats:
            point.say("", "taken", f"seat of {seats[part.id]}")
            return seats[part.id]
    point.say("", "derived", "carries no bearing of the scene: it follows free of force")
    return None


def _stiffness(group: Part, points: int) -> FloatArray | None:
    """Return the matrix in N, m, rad, None if the account says why there is none."""
    rows = group.value(_MATRIX)
    if rows is None:
        group.say("", "refused", f"no {_MATRIX}: files of finite-element programs are not read")
        return None
    size = _PER_POINT * points
    if (
        not isinstance(rows, tuple)
        or len(rows) != size
        or any(not isinstance(row, tuple) or len(row) != size for row in rows)
    ):
        group.say(
            _MATRIX, "refused", f"{size} rows of {size} numbers are needed: six for each reduction point"
        )
        return None
    try:
        matrix = np.array(rows, dtype=float)
    except (TypeError, ValueError):
        group.say(_MATRIX, "refused", "not all of its entries are numbers")
        return None
    scale = np.tile([1e3**0.5] * 3 + [1e-3**0.5] * 3, points)
    matrix *= scale[:, None] * scale
    most = float(np.max(np.abs(matrix)))
    if not np.isfinite(most) or np.any(np.abs(matrix - matrix.T) > SYMMETRIC * most):
        group.say(_MATRIX, "refused", "not symmetric, or not finite")
        return None
    return np.asarray(0.5 * (matrix + matrix.T))


def _condensed(matrix: FloatArray, kept: list[int]) -> FloatArray:
    """Return the stiffness over some points, the others free of force."""
    rows = np.concatenate([np.arange(_PER_POINT * index, _PER_POINT * (index + 1)) for index in kept])
    free = np.setdiff1d(np.arange(len(matrix)), rows)
    if not free.size:
        return matrix
    follow = np.linalg.pinv(matrix[np.ix_(free, free)]) @ matrix[np.ix_(free, rows)]
    return np.asarray(matrix[np.ix_(rows, rows)] - matrix[np.ix_(rows, free)] @ follow)
