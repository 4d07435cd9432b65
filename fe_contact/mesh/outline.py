"""Outlines of sections: their pieces, and the grading of nodes along them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fe_contact.types import FloatArray, IntArray

# Division of curves into edges whose length follows a size function.


SizeFunction = Callable[[FloatArray], FloatArray]


def divide(start: float, end: float, size: SizeFunction, samples: int = 2001) -> FloatArray:
    """Divide an interval so that every part is as long as `size` asks, within the rounding of their number.

    Parameters
    ----------
    start, end : float
        Ends of the interval; `end` may be below `start`.
    size : callable
        Wanted length of a part at the coordinates given, > 0, in the unit of the coordinate.
    samples : int
        Points at which `size` is evaluated.

    Returns
    -------
    (n + 1,) array
        Ends of the n >= 1 parts from `start` to `end`, both exact.
    """
    t = np.linspace(start, end, samples)
    density = 1.0 / size(t)
    parts = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.abs(np.diff(t)))])
    count = max(1, int(np.ceil(parts[-1] - 1e-9)))
    # Interpolation needs an increasing abscissa: `parts` is one in either direction of the interval.
    ends = np.interp(np.linspace(0.0, parts[-1], count + 1), parts, t)
    ends[0], ends[-1] = start, end
    return ends


def middles(ends: FloatArray) -> FloatArray:
    """Return the middle of each part."""
    return 0.5 * (ends[1:] + ends[:-1])


def spread(
    points: FloatArray, sizes: FloatArray, growth: float, largest: float
) -> Callable[[FloatArray], FloatArray]:
    """Return the size at a distance from sources of known size: min(largest, size_p + growth |x - p|).

    Parameters
    ----------
    points : (n, 2) array
        Sources, m.
    sizes : (n,) array
        Size at each, m.
    growth : float
        Growth per unit distance.
    largest : float
        Upper bound, m.

    Returns
    -------
    callable
        Maps (k, 2) points to (k,) sizes.
    """
    from scipy.spatial.distance import cdist  # noqa: PLC0415 (start-up time)

    def size(at: FloatArray) -> FloatArray:
        nearest: FloatArray = np.min(sizes + growth * cdist(at, points), axis=1)
        return np.minimum(nearest, largest)

    return size


Curve = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class Piece:
    """Part of an outline: its nodes (2n + 1, 2) from end to end, corner, mid-side, corner ..."""

    name: str
    nodes: FloatArray

    @property
    def edges(self) -> int:
        """Number of edges."""
        return len(self.nodes) // 2

    @property
    def edge_lengths(self) -> FloatArray:
        """Chord of each edge, m."""
        chords: FloatArray = np.linalg.norm(np.diff(self.nodes[::2], axis=0), axis=1)
        return chords


def piece(name: str, curve: Curve, ends: FloatArray) -> Piece:
    """Return the piece of `curve` divided at the parameters `ends`, mid-side nodes at the mid parameters."""
    parameters = np.empty(2 * len(ends) - 1)
    parameters[::2], parameters[1::2] = ends, middles(ends)
    return Piece(name, curve(parameters))


def arc(radius: float) -> Curve:
    """Return the circle about the origin by angle from +y, positive towards +x."""
    return lambda angle: radius * np.stack([np.sin(angle), np.cos(angle)], axis=-1)


def radial_line(angle: float) -> Curve:
    """Return the straight line through the origin at `angle` from +y (positive towards +x) by radius."""
    direction = np.array([np.sin(angle), np.cos(angle)])
    return lambda radius: np.asarray(radius)[:, None] * direction


@dataclass(frozen=True)
class Outline:
    """Closed loop of pieces, each beginning where the one before ends.

    Counter-clockwise around material, clockwise around a hole.
    """

    pieces: tuple[Piece, ...]

    @property
    def nodes(self) -> FloatArray:
        """All nodes once, (2n, 2): corner, mid-side, corner ... mid-side."""
        return np.concatenate([p.nodes[:-1] for p in self.pieces])

    @property
    def corners(self) -> FloatArray:
        """Corner points, (n, 2)."""
        return self.nodes[::2]

    def reversed(self) -> Outline:
        """Return the same nodes the other way round from the same first one: a hole's rim as an outline."""
        return Outline(tuple(Piece(p.name, p.nodes[::-1]) for p in self.pieces[::-1]))

    def positions(self, name: str) -> IntArray:
        """Return where in `nodes` the piece `name` lies, from its first node to its last inclusive."""
        start = 0
        for p in self.pieces:
            if p.name == name:
                return np.arange(start, start + len(p.nodes)) % len(self.nodes)
            start += len(p.nodes) - 1
        raise KeyError(name)
