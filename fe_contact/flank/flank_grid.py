"""A free-form flank: material removed, given on a grid over roll length and face position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bounds import SiNote
from fe_contact.errors import InputError, increasing, within
from fe_contact.flank.extent import Extent
from fe_contact.types import FloatArray

_LARGEST = 0.01  # m; catches micrometers given as meters
LARGEST_INVENTION = 0.1e-6
"""Allowed distance of the surface from the range of its nodes, m, beyond what their curvature explains."""
_CONFIRMING = 4
"""Neighboring second differences that confirm a curvature; three next to a border of five nodes."""
_MAX_UNLIKE = 3.0
"""Largest ratio of second differences that confirm a curvature: a parabola has 1, flats by reliefs more."""
_STEEPEST = 3.0
"""Bound of the slope of a monotone cubic over that of its chord."""


@dataclass(frozen=True)
class FlankGrid:
    """Material removed at the nodes of a grid; sequences are stored as tuples.

    Raises `InputError`: axes that do not increase, rows of another length, values that are no numbers or
    above 1 cm; nodes between which the surface would leave them by more than 0.1 um beyond what curvature
    makes it.

    Notes
    -----
    Between the nodes: the cubic Hermite interpolant of either direction. It is C1, as the search for the
    touching point needs: contact would stay at the kinks of a bilinear surface and then jump. Its slopes are
    those of the parabola through three neighboring nodes, limited so that the surface stays between the
    values at the ends of a cell (Huynh, Accurate monotone cubic interpolation, SIAM J. Numer. Anal. 30, 1993,
    constraint M4). It leaves them where at least three second differences around the cell agree in sign and
    within a factor of 3, and then by what the lesser of those at its ends makes it: twist and parabolic
    crowning on five nodes or more come out to rounding. Beyond the grid the end value applies.
    """

    roll_length: tuple[float, ...]
    """Roll lengths of the nodes in m, increasing, at least two."""
    face_position: tuple[float, ...]
    """Distances of the nodes from mid-face in m, increasing, at least two."""
    removed: tuple[tuple[float, ...], ...]
    """Material removed in m, normal to the involute in the transverse plane: one row per roll length."""

    def __post_init__(self) -> None:
        for name in ("roll_length", "face_position"):
            values = getattr(self, name)
            nodes = increasing(name, values)
            if nodes.size < 2:
                raise InputError(name, list(values), "a list of at least two")
            object.__setattr__(self, name, tuple(nodes.tolist()))
        shape = (len(self.roll_length), len(self.face_position))
        if len(self.removed) != shape[0]:
            bound = f"{shape[0]} rows, one per roll length"
            raise InputError("removed", f"{len(self.removed)} rows", bound)
        rows = tuple(_row(i, row, shape[1]) for i, row in enumerate(self.removed))
        object.__setattr__(self, "removed", rows)
        self._refuse_invented()

    def _refuse_invented(self) -> None:
        """Refuse nodes between which the surface invents material."""
        beyond = _cell_excess(self.nodes, np.array(self.roll_length), np.array(self.face_position))
        i, j = np.unravel_index(beyond.argmax(), beyond.shape)
        if beyond[i, j] > LARGEST_INVENTION:
            value = f"{1e6 * beyond[i, j]:.3g} µm beyond the nodes around it"
            bound = f"at most {1e6 * LARGEST_INVENTION:g} µm; add nodes beside the steps of the flank"
            raise InputError(f"removed[{i}..{i + 1}][{j}..{j + 1}]", value, bound)

    @cached_property
    def neutral(self) -> bool:
        """Whether nothing is removed anywhere."""
        return not any(any(row) for row in self.removed)

    @cached_property
    def varies_along_face(self) -> bool:
        """Whether any row differs along the face."""
        return any(value != row[0] for row in self.removed for value in row)

    def material_removed(self, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """Return the material removed in m at roll lengths and face positions in m, arrays of equal shape."""
        from fe_contact.flank.bicubic import bicubic  # noqa: PLC0415 (loads the compiler)

        points = (np.ascontiguousarray(axis, dtype=float).ravel() for axis in (roll_length, face_position))
        axes = np.array(self.roll_length), np.array(self.face_position)
        removed = bicubic(*axes, self.nodes.reshape(4, -1), *points)
        return np.asarray(removed.reshape(roll_length.shape))

    def extent(self, ends: tuple[float, float]) -> Extent:
        """Return bounds of the material removed on a usable profile between the roll lengths `ends` in m.

        At the ends of the grid the slope drops to zero.
        """
        roll, slope, inside = self.roll_length, np.abs(self.nodes[1]).max(axis=1), self._extent
        kink = max(slope[0] if roll[0] > min(ends) else 0.0, slope[-1] if roll[-1] < max(ends) else 0.0)
        return replace(inside, kink=float(kink))

    @cached_property
    def _extent(self) -> Extent:
        """The extent of a surface between its nodes.

        It leaves the range of its nodes by no more than it is allowed to. A monotone cubic is at most three
        times as steep as its chord, and most curved at one of the ends of its cell.
        """
        values, roll = np.array(self.removed), np.array(self.roll_length)
        heights = (
            float(np.max(_sagitta(values, axis, direction)))
            for direction, axis in enumerate((roll, np.array(self.face_position)))
        )
        between = 0.0 if self.neutral else LARGEST_INVENTION + sum(heights)
        step, slope = np.diff(roll)[:, None], self.nodes[1]
        rise = np.diff(values, axis=0)
        bend = 6.0 * rise / step**2
        first = bend - (4.0 * slope[:-1] + 2.0 * slope[1:]) / step
        last = bend - (2.0 * slope[:-1] + 4.0 * slope[1:]) / step
        return Extent(
            low=float(values.min()) - between,
            high=float(values.max()) + between,
            slope=_STEEPEST * float((np.abs(rise) / step).max()),
            spread=float(np.ptp(values, axis=0).max()),
            bend=float(max(np.abs(first).max(), np.abs(last).max())),
        )

    @cached_property
    def nodes(self) -> FloatArray:
        """Value, slope along the profile, along the face, and mixed slope at the nodes, (4, m, n)."""
        value, roll, face = np.array(self.removed), np.array(self.roll_length), np.array(self.face_position)
        along_roll, along_face = _slope(value, roll, 0), _slope(value, face, 1)
        mixed = _lesser(_slope(along_roll, face, 1), _slope(along_face, roll, 0))
        return np.stack([value, along_roll, along_face, mixed])


def _row(index: int, row: Sequence[float], length: int) -> tuple[float, ...]:
    if len(row) != length:
        raise InputError(f"removed[{index}]", f"{len(row)} values", f"{length} values, one per face position")
    remedy = SiNote("In m: 5 µm is 5e-6.")
    return tuple(within(f"removed[{index}][{j}]", v, -_LARGEST, _LARGEST, remedy) for j, v in enumerate(row))


def _slope(values: FloatArray, axis: FloatArray, direction: int) -> FloatArray:
    """Return limited slopes at the nodes; the slope of the line where there are two nodes only."""
    along = np.moveaxis(values, direction, 0)
    step = np.diff(axis)[:, None]
    secant = np.diff(along, axis=0) / step
    if len(secant) == 1:
        return np.moveaxis(np.repeat(secant, 2, axis=0), 0, direction)
    curvature = _curvature(secant, step)
    # slopes of a cell's parabola at its end, which lies before a node, and at its start, which lies after one
    before, after = secant + curvature * step, secant - curvature * step
    bound = _lesser(before[:-1], after[1:])
    limit = np.maximum(3.0 * np.abs(_lesser(secant[:-1], secant[1:])), 1.5 * np.abs(bound))
    parabola = (step[1:] * secant[:-1] + step[:-1] * secant[1:]) / (step[:-1] + step[1:])
    inner = _lesser(parabola, np.copysign(limit, bound))
    first = _end_slope(secant[0], secant[1], step[0], step[1], after[0])
    last = _end_slope(secant[-1], secant[-2], step[-1], step[-2], before[-1])
    return np.moveaxis(np.stack([first, *inner, last]), 0, direction)


def _end_slope(
    secant: FloatArray, inner: FloatArray, step: FloatArray, next_step: FloatArray, confirmed: FloatArray
) -> FloatArray:
    """Return the slope at a border: the confirmed one, or that of the parabola, limited not to turn back."""
    parabola = secant + (secant - inner) * step / (step + next_step)
    return np.where(confirmed != secant, confirmed, _lesser(parabola, 3.0 * secant))


def _curvature(secant: FloatArray, step: FloatArray) -> FloatArray:
    """Return half the second derivative in every cell: the lesser one of its ends, 0 if unconfirmed."""
    at_nodes = np.diff(secant, axis=0) / (step[:-1] + step[1:])  # of inner nodes
    cells, nodes = len(secant), len(at_nodes)
    if nodes < _CONFIRMING - 1:
        return np.zeros_like(secant)
    count = min(_CONFIRMING, nodes)
    # the nodes around each cell, from the one before its start, moved inwards at a border; (cells, count)
    around = np.clip(np.arange(cells) - 2, 0, nodes - count)[:, None] + np.arange(count)
    low, high = at_nodes[around].min(axis=1), at_nodes[around].max(axis=1)
    sizes = np.sort(np.abs([low, high]), axis=0)
    alike = _MAX_UNLIKE * sizes[0] > sizes[1]
    ends = np.concatenate([at_nodes[:1], at_nodes, at_nodes[-1:]])  # a border has that of the next node
    return np.where(alike & (low * high > 0.0), _lesser(ends[:-1], ends[1:]), 0.0)


def _lesser(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the value nearer to 0; 0 where they differ in sign."""
    return np.where(first * second > 0.0, np.copysign(np.minimum(np.abs(first), np.abs(second)), first), 0.0)


def _cell_excess(nodes: FloatArray, roll: FloatArray, face: FloatArray) -> FloatArray:
    """Return the distance of the surface from its nodes in each cell, m, less the height by curvature."""
    at = np.linspace(0.0, 1.0, 9)
    weights = [_hermite_weights(at, axis) for axis in (roll, face)]
    value, along_roll, along_face, mixed = nodes
    ends = np.stack([[value, along_face], [along_roll, mixed]])  # (order in roll, in face, m, n)
    m, n = value.shape
    # ends a, b of cell i, j and orders p, q along roll and face: (a, b, p, q, i, j); points k, l in a cell
    corners = np.stack([[ends[..., a : m - 1 + a, b : n - 1 + b] for b in (0, 1)] for a in (0, 1)])
    surface = np.einsum("kapi,lbqj,abpqij->klij", *weights, corners, optimize=True)
    values = corners[:, :, 0, 0].reshape(4, *surface.shape[2:])
    out = np.maximum(surface.max((0, 1)) - values.max(0), values.min(0) - surface.min((0, 1)))
    return np.asarray(out - _sagitta(value, roll, 0) - _sagitta(value, face, 1))


def _hermite_weights(at: FloatArray, axis: FloatArray) -> FloatArray:
    """Return weights (points, end, value or slope, cells) of the cubic Hermite interpolant."""
    step, back = np.diff(axis), 1.0 - at
    value = np.stack([(1.0 + 2.0 * at) * back**2, at**2 * (3.0 - 2.0 * at)], axis=1)
    slope = np.stack([at * back**2, -back * at**2], axis=1)
    return np.stack([value[..., None] + 0.0 * step, slope[..., None] * step], axis=2)


def _sagitta(values: FloatArray, axis: FloatArray, direction: int) -> FloatArray:
    """Return the height of the parabola over the chord in each cell, m: the higher of two opposite sides."""
    if len(axis) < 3:
        return np.zeros(())  # two nodes: a straight line
    along = np.moveaxis(values, direction, 0)
    step = np.diff(axis)[:, None]
    height = 0.25 * step**2 * np.abs(_curvature(np.diff(along, axis=0) / step, step))
    return np.moveaxis(np.maximum(height[:, :-1], height[:, 1:]), 0, direction)
