"""The elastic housing: the reduced stiffness matrix of the casing's assembly group."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bounds.types import FloatArray
from dynamics.bearings.matrix import least_share
from dynamics.joints.housing import DEFINITE
from lineofaction.gearbox.from_rexs.bearing_location import Table
from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.part_names import Names
from lineofaction.gearbox.from_rexs.placement import FIXED, Placement

_MATRIX = "reduced_static_stiffness_matrix"

_PER_POINT = 6
"""Degrees of freedom of a reduction point."""

_SYMMETRIC = 1e-6
"""Relative asymmetry up to which a matrix counts as symmetric: finite-element programs write matrices with
that many digits."""


def elastic_housings(layout: Layout, seats: dict[int, str]) -> Iterator[Table]:
    """Yield the housings whose points carry bearings.

    The matrix of the file has six rows a point, motions along and rotations about u, v, w of its assembly
    group, in N, mm, rad, and the order of the points. Points that carry no bearing of the scene follow free
    of force (static condensation). `seats` has the names of the bushings by component.
    """
    names = Names()
    for group in _groups(layout):
        points = group.children("reduction_point")
        bearings = [_seat_of(point, seats) for point in points]
        matrix = _stiffness(group, len(points))
        if matrix is None:
            continue
        if not any(bearings):
            group.say("", "refused", "no reduction point refers to a bearing of the scene")
            continue
        rotation = np.kron(np.eye(2 * len(points)), layout.axes.rotation(Placement.of(group) or FIXED))
        scene_matrix = rotation @ matrix @ rotation.T
        rows = [index for index, name in enumerate(bearings) if name]
        group.say("", "taken", "elastic housing")
        text = f"stiffness under {len(rows)} bearings; u, v, w turned to x, y, z, mm to m"
        group.say(_MATRIX, "taken", text)
        yield {
            "name": names.of(group),
            "bushings": [name for name in bearings if name],
            "stiffness_matrix": _condensed(scene_matrix, rows).tolist(),
        }


def loosely_housed(layout: Layout) -> set[int]:
    """Return the components in an elastic housing that is not held in all directions: its matrix is singular.

    The scene has linear bearings in such a housing: force laws need a regular matrix.
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


def _seat_of(point: Part, seats: dict[int, str]) -> str | None:
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
    lengths = [len(row) for row in rows if isinstance(row, tuple)] if isinstance(rows, tuple) else []
    if not isinstance(rows, tuple) or len(rows) != size or lengths != [size] * size:
        text = f"{size} rows of {size} numbers are needed: six for each reduction point"
        group.say(_MATRIX, "refused", text)
        return None
    try:
        matrix = np.array(rows, dtype=float)
    except (TypeError, ValueError):
        group.say(_MATRIX, "refused", "not all of its entries are numbers")
        return None
    # N/mm times 1e3 is N/m, N stays, N mm times 1e-3 is N m; an entry has those of its row and its column
    scale = np.tile([1e3**0.5] * 3 + [1e-3**0.5] * 3, points)
    matrix *= scale[:, None] * scale
    largest = float(np.max(np.abs(matrix)))
    if not np.isfinite(largest) or np.any(np.abs(matrix - matrix.T) > _SYMMETRIC * largest):
        group.say(_MATRIX, "refused", "not symmetric, or not finite")
        return None
    return np.asarray(0.5 * (matrix + matrix.T))


def _condensed(matrix: FloatArray, points: list[int]) -> FloatArray:
    """Return the stiffness over some points, the others free of force."""
    rows = np.concatenate([np.arange(_PER_POINT * index, _PER_POINT * (index + 1)) for index in points])
    free = np.setdiff1d(np.arange(len(matrix)), rows)
    if not free.size:
        return matrix
    follow = np.linalg.pinv(matrix[np.ix_(free, free)]) @ matrix[np.ix_(free, rows)]
    return np.asarray(matrix[np.ix_(rows, rows)] - matrix[np.ix_(rows, free)] @ follow)
