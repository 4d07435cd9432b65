"""Piecewise cubic curves laid out for compiled functions: laws of time, torques by speed, springs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.kernels.compiled import inner
from dynamics.types import FloatArray, IntArray


class Cubics(NamedTuple):
    """Curves one after the other in flat arrays."""

    first: IntArray
    """First piece of each curve. Shape (l + 1,)."""
    start: FloatArray
    """Start of the pieces. Shape (S,)."""
    coefficient: FloatArray
    """Ascending coefficients above the piece's start. Shape (S, 4)."""

    @classmethod
    def packed(cls, curves: Sequence[tuple[FloatArray, FloatArray]]) -> Cubics:
        """Lay out curves, each by start (s,) and coefficients (s, 4) of its pieces."""
        return cls(
            np.cumsum([0, *(start.size for start, _ in curves)], dtype=np.int64),
            np.concatenate([np.empty(0), *(start for start, _ in curves)]),
            np.ascontiguousarray(np.concatenate([np.empty((0, 4)), *(values for _, values in curves)])),
        )


@inner
def piece_at(curves: Cubics, index: int, at: float) -> int:
    """Return the piece of curve `index` that holds `at`."""
    piece = curves.first[index]
    while piece + 1 < curves.first[index + 1] and at >= curves.start[piece + 1]:
        piece += 1
    return int(piece)


@inner
def value_and_slope(curves: Cubics, index: int, at: float) -> tuple[float, float]:
    """Return curve `index` and its derivative at `at`."""
    return cubic(curves, piece_at(curves, index, at), at)


@inner
def cubic(curves: Cubics, piece: int, at: float) -> tuple[float, float]:
    """Return a piece and its derivative at `at`."""
    s, c = at - curves.start[piece], curves.coefficient
    value = c[piece, 0] + s * (c[piece, 1] + s * (c[piece, 2] + s * c[piece, 3]))
    return value, c[piece, 1] + s * (2.0 * c[piece, 2] + 3.0 * s * c[piece, 3])


@inner
def area(curves: Cubics, piece: int, s: float) -> float:
    """Return the integral of a piece from its start over `s`."""
    c = curves.coefficient
    return float(
        s * (c[piece, 0] + s * (c[piece, 1] / 2.0 + s * (c[piece, 2] / 3.0 + s * c[piece, 3] / 4.0)))
    )
