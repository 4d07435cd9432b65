"""The beam of a stepped or conical shaft after Timoshenko: bending with shear, torsion, tension."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bounds import Text, above, from_to
from dynamics.checks import finite
from dynamics.errors import InputError
from dynamics.shafts.beam_elements import ElementMatrices, Piece, beam_elements
from dynamics.shafts.beam_section import BeamSection
from dynamics.shafts.shaft import SAME_POSITION, nearest_on, on_length
from dynamics.types import FloatArray, IntArray

PER_NODE = 6
"""Freedoms of a node: x, y, z, tilt_x, tilt_y, rotation about z."""


@dataclass(frozen=True)
class TimoshenkoBeam:
    """N nodes of six freedoms each, node by node; free in space."""

    position: FloatArray
    """Along z from the left end, m. Shape (N,)."""
    mass: FloatArray
    stiffness: FloatArray
    """`mass`, `stiffness`: Symmetric; kg, N/m and with m, rad. Shape (6 N, 6 N) each."""

    def freedoms(self, position: float) -> IntArray:
        """Return the indices of the six freedoms of the node at `position` (m)."""
        node = int(np.argmin(np.abs(self.position - position)))
        if abs(self.position[node] - position) > SAME_POSITION * self.position[-1]:
            raise InputError("position", position, "at a node", "Name it as a station of the beam.")
        return np.arange(PER_NODE * node, PER_NODE * node + PER_NODE, dtype=np.int64)


def timoshenko_beam(
    sections: Sequence[BeamSection], stations: Sequence[float] = (), longest: float = math.inf
) -> TimoshenkoBeam:
    """Return the beam of `sections` from left to right.

    The shape functions of its two-node elements solve the static equations between nodes, in cones too, so
    that deflections under forces at nodes are exact. Shear is constant in an element. The error of a natural
    frequency falls with the square of the element length in the share of shear, else with its fourth power.
    Rotary inertia and shear are in the consistent mass (Przemieniecki, Theory of Matrix Structural Analysis,
    1968). Raises `InputError`: without a section, for a station off the beam, or for a `longest` that is not
    above zero.

    Parameters
    ----------
    stations : sequence of float
        Positions where forces act, m from the left end; each becomes a node.
    longest : float
        Largest length of an element, m.
    """
    if not sections:
        raise InputError("sections", 0, "at least one section")
    if not longest > 0.0:
        raise InputError("longest", longest, above(0.0))
    ends = np.cumsum([0.0, *(section.length for section in sections)])
    length = float(ends[-1])
    for index, station in enumerate(stations):
        if not on_length(finite(f"stations[{index}]", station), length):
            bound = Text.of("on the beam, ", from_to(0.0, length, "m"))
            raise InputError(f"stations[{index}]", station, bound)
    starts = zip(sections, ends, strict=False)  # the last of the ends starts no section
    # further nodes in steep cones, in which diameters change much
    graded = [start + share * part.length for part, start in starts for share in part.grading]
    node = _nodes(ends, [*graded, *(nearest_on(station, length) for station in stations)], longest)
    size = PER_NODE * node.size
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    pieces = []
    for left, right in pairwise(node):
        # the section that holds the middle of the element
        index = int(np.searchsorted(ends, 0.5 * (left + right), side="right")) - 1
        start, span = ends[index], sections[index].length
        pieces.append(Piece(sections[index], float((left - start) / span), float((right - start) / span)))
    for k, (m, s) in enumerate(zip(*_coupled(beam_elements(pieces)), strict=True)):
        rows = slice(PER_NODE * k, PER_NODE * k + 2 * PER_NODE)  # freedoms of the nodes k and k + 1
        mass[rows, rows] += m
        stiffness[rows, rows] += s
    return TimoshenkoBeam(node, mass, stiffness)


def _nodes(ends: FloatArray, stations: Sequence[float], longest: float) -> FloatArray:
    """Return the nodes (N,), m: ends of sections, `stations`, and equal parts of intervals above `longest`.

    Positions that differ by rounding are one node.
    """
    positions = np.sort(np.concatenate([ends, np.asarray(stations, dtype=float)]))
    distinct_nodes = np.concatenate([[True], np.diff(positions) > SAME_POSITION * ends[-1]])
    nodes = positions[distinct_nodes]
    parts = []
    for left, right in pairwise(nodes):
        # rounding of a length that fits exactly adds no node
        count = max(math.ceil((right - left) / longest * (1.0 - SAME_POSITION)), 1)
        parts.append(np.linspace(left, right, count, endpoint=False))
    return np.concatenate([*parts, nodes[-1:]])


def _coupled(elements: ElementMatrices) -> tuple[FloatArray, FloatArray]:
    """Return mass and stiffness (k, 12, 12) of k elements in all freedoms of their two nodes."""
    size = (elements.axial.shape[0], 2 * PER_NODE, 2 * PER_NODE)
    mass, stiffness = np.zeros(size), np.zeros(size)
    # bending in x with tilt_y, in y with tilt_x: u_x' = tilt_y, u_y' = -tilt_x
    for first, tilt, slope in ((0, 4, 1.0), (1, 3, -1.0)):
        sign = np.array([1.0, slope, 1.0, slope])
        sign = sign[:, None] * sign
        dofs = np.array([first, tilt, first + PER_NODE, tilt + PER_NODE])
        mass[:, dofs[:, None], dofs] = sign * elements.bending_mass
        stiffness[:, dofs[:, None], dofs] = sign * elements.bending
    # tension along z (freedom 2) and torsion about z (freedom 5): rods
    for first, rod_mass, rod in (
        (2, elements.axial_mass, elements.axial),
        (5, elements.torsional_mass, elements.torsion),
    ):
        dofs = np.array([first, first + PER_NODE])
        mass[:, dofs[:, None], dofs], stiffness[:, dofs[:, None], dofs] = rod_mass, rod
    return mass, stiffness
