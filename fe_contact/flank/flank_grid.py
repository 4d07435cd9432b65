"""A free-form flank: material removed, given on a grid over roll length and face position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from bounds import SiNote
from fe_contact.errors import InputError, increasing, within
from fe_contact.types import FloatArray

_LARGEST = 0.01  # m; catches micrometers given as meters


@dataclass(frozen=True)
class FlankGrid:
    """Material removed at the nodes of a grid; sequences are stored as tuples.

    Attributes
    ----------
    roll_length : tuple of float
        Roll lengths of the nodes in m, increasing, at least two.
    face_position : tuple of float
        Distances of the nodes from mid-face in m, increasing, at least two.
    removed : tuple of tuple of float
        Material removed in m, normal to the involute in the transverse plane: one row per roll length.

    Raises
    ------
    InputError
        Axes that do not increase, rows of another length, values that are no numbers or above 1 cm.

    Notes
    -----
    Between the nodes: the cubic Hermite interpolant of either direction, with the slopes of the parabola
    through three neighboring nodes. It is C1, as the search for the touching point needs (contact would stay
    at the kinks of a bilinear surface and then jump), reproduces twist and parabolic crowning to rounding,
    and spreads an error of one node over two cells. Beside a step between even nodes it overshoots by 2/27 of
    it, at the border of the grid by 1/8. Beyond the grid the end value applies.
    """

    roll_length: tuple[float, ...]
    face_position: tuple[float, ...]
    removed: tuple[tuple[float, ...], ...]

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

    @cached_property
    def neutral(self) -> bool:
        """Whether nothing is removed anywhere."""
        return not any(any(row) for row in self.removed)

    @cached_property
    def varies_along_face(self) -> bool:
        """Whether any row differs along the face."""
        return any(value != row[0] for row in self.removed for value in row)

    def material_removed(self, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """Material removed in m at roll lengths and face positions in m, arrays of equal shape."""
        import host.analysis  # noqa: F401, PLC0415 (says what to install)
        from fe_contact.flank.bicubic import bicubic  # noqa: PLC0415 (loads the compiler)

        flat = (np.ascontiguousarray(axis, dtype=float).ravel() for axis in (roll_length, face_position))
        removed = bicubic(np.array(self.roll_length), np.array(self.face_position), self._nodes, *flat)
        return np.asarray(removed.reshape(roll_length.shape))

    @cached_property
    def _nodes(self) -> FloatArray:
        """Value, slope along the profile, along the face, and mixed slope at the nodes, (4, m, n)."""
        value = np.array(self.removed)
        along_roll = _slope(value, self.roll_length, 0)
        return np.stack(
            [
                value,
                along_roll,
                _slope(value, self.face_position, 1),
                _slope(along_roll, self.face_position, 1),
            ]
        )


def _row(index: int, row: Sequence[float], length: int) -> tuple[float, ...]:
    if len(row) != length:
        raise InputError(f"removed[{index}]", f"{len(row)} values", f"{length} values, one per face position")
    advice = SiNote("In m: 5 um is 5e-6.")
    return tuple(within(f"removed[{index}][{j}]", v, -_LARGEST, _LARGEST, advice) for j, v in enumerate(row))


def _slope(values: FloatArray, axis: tuple[float, ...], direction: int) -> FloatArray:
    """Slope at the nodes of the parabola through three neighbors; of the straight line where two are all."""
    order: Literal[1, 2] = 2 if len(axis) > 2 else 1
    return np.asarray(np.gradient(values, np.array(axis), axis=direction, edge_order=order))
