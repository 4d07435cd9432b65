"""Outlines of sections: their pieces, and the grading of nodes along them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fe_contact.mesh.curve_division import middles
from fe_contact.types import FloatArray, IntArray

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
