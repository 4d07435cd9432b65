"""The beam of a stepped or conical shaft after Timoshenko: bending with shear, torsion, tension."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bounds import Text, above, from_to
from dynamics.checks import finite
from dynamics.errors import InputError
from dynamics.shafts.beam_section import BeamSection
from dynamics.shafts.shaft import SAME_POSITION, nearest_on, on_length
from dynamics.types import FloatArray, IntArray

# Beam elements of varying cross section, from the flexibility of a clamped piece: exact under end forces.


POINTS = 12
"""Gauss points along an element. Against 60 of them, entries of its matrices are within 5e-13 where diameters
vary by a factor of 2, within 2e-6 at a factor of 4."""

_GAUSS = np.polynomial.legendre.leggauss(POINTS)
_SHARE, _WEIGHT = 0.5 * (1.0 + _GAUSS[0]), 0.5 * _GAUSS[1]
PER_NODE = 6
"""Freedoms of a node: x, y, z, tilt_x, tilt_y, rotation about z."""


class _Piece(NamedTuple):
    """A part of a section: `start` and `end` in shares of its length."""

    section: BeamSection
    start: float
    end: float

    @property
    def length(self) -> float:
        """M."""
        return (self.end - self.start) * self.section.length


class _ElementMatrices(NamedTuple):
    """Mass and stiffness of k elements, at their left and then their right ends."""

    bending_mass: FloatArray
    bending: FloatArray
    """`bending_mass`, `bending`: In one plane: deflection (m) and its slope (rad). Shape (k, 4, 4) each."""
    axial_mass: FloatArray
    axial: FloatArray
    torsional_mass: FloatArray
    torsion: FloatArray
    """`axial_mass`, `axial`, `torsional_mass`, `torsion`: Displacement along the axis, m; rotation, rad.
    Shape (k, 2, 2) each.
    """


class _Along(NamedTuple):
    """Of k pieces at n points along them: stiffnesses and masses per length, (k, n)."""

    bent: FloatArray
    sheared: FloatArray
    pulled: FloatArray
    twisted: FloatArray
    mass: FloatArray
    diametral: FloatArray


def _beam_elements(pieces: Sequence[_Piece]) -> _ElementMatrices:
    length = np.array([piece.length for piece in pieces])
    at, inside = _along(pieces, _SHARE), _along(pieces, np.outer(_SHARE, _SHARE))
    bending_mass, bending = _bending(length, at, inside)
    axial_mass, axial = _rod(length, at.pulled, inside.pulled, at.mass)
    torsional_mass, torsion = _rod(length, at.twisted, inside.twisted, 2.0 * at.diametral)
    return _ElementMatrices(bending_mass, bending, axial_mass, axial, torsional_mass, torsion)


def _along(pieces: Sequence[_Piece], share: FloatArray) -> _Along:
    """Return the properties at shares (...) of the pieces, (k, ...) each."""
    rows = []
    for section, start, end in pieces:
        cut = section.cross_section(start + share * (end - start))
        young, shear, density = section.youngs_modulus, section.shear_modulus, section.density
        rows.append(
            (
                young * cut.second_moment,
                cut.shear_coefficient * shear * cut.area,
                young * cut.area,
                2.0 * shear * cut.second_moment,
                density * cut.area,
                density * cut.second_moment,
            )
        )
    return _Along(*(np.array(column) for column in zip(*rows, strict=True)))


def _bending(length: FloatArray, at: _Along, inside: _Along) -> tuple[FloatArray, FloatArray]:
    """Mass and stiffness (k, 4, 4) in one plane."""
    far = length[:, None] * (1.0 - _SHARE)
    step = length[:, None] * _WEIGHT
    tip = _stacked(
        np.sum(step * (far**2 / at.bent + 1.0 / at.sheared), axis=1),
        np.sum(step * far / at.bent, axis=1),
        np.sum(step * far / at.bent, axis=1),
        np.sum(step / at.bent, axis=1),
    )
    one, none = np.ones_like(length), np.zeros_like(length)
    relative = np.stack(
        [np.stack([-one, -length, one, none], axis=-1), np.stack([none, -one, none, one], axis=-1)], axis=1
    )
    held = np.linalg.solve(tip, relative)
    stiffness = relative.transpose(0, 2, 1) @ held
    s = length[:, None] * _SHARE
    shape = _deflection(length, inside) @ held[:, None]
    shape[..., 0, 0] += 1.0
    shape[..., 0, 1] += s
    shape[..., 1, 1] += 1.0
    per = np.stack([step * at.mass, step * at.diametral], axis=-1)
    mass = np.einsum("kpai,kpa,kpaj->kij", shape, per, shape)
    return mass, 0.5 * (stiffness + stiffness.transpose(0, 2, 1))


def _deflection(length: FloatArray, inside: _Along) -> FloatArray:
    """Deflection and rotation at the points per force and moment at the right end, (k, n, 2, 2)."""
    s = length[:, None, None] * _SHARE[:, None]
    t, step = s * _SHARE, s * _WEIGHT
    rest, arm = s - t, length[:, None, None] - t
    return _stacked(
        np.sum(step * (rest * arm / inside.bent + 1.0 / inside.sheared), axis=-1),
        np.sum(step * rest / inside.bent, axis=-1),
        np.sum(step * arm / inside.bent, axis=-1),
        np.sum(step / inside.bent, axis=-1),
    )


def _rod(
    length: FloatArray, at: FloatArray, inside: FloatArray, mass: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Mass and stiffness (k, 2, 2) of what is pulled or twisted; `at`, `inside` stiffnesses of a length."""
    step = length[:, None] * _WEIGHT
    whole = np.sum(step / at, axis=1)
    moved = np.sum(length[:, None, None] * _SHARE[:, None] * _WEIGHT / inside, axis=-1) / whole[:, None]
    shape = np.stack([1.0 - moved, moved], axis=-1)
    stiffness = np.array([[1.0, -1.0], [-1.0, 1.0]]) / whole[:, None, None]
    return np.einsum("kpi,kp,kpj->kij", shape, step * mass, shape), stiffness


def _stacked(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    return np.stack([np.stack([a, b], axis=-1), np.stack([c, d], axis=-1)], axis=-2)


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

    Two-node elements whose shape functions solve the static equations between nodes, in cones too:
    deflections under forces at nodes are exact. Shear is constant in an element, so natural frequencies
    converge with the square of its length in their part that shear makes, with the fourth power in the rest.
    Rotary inertia and shear are in the consistent mass (Przemieniecki, Theory of Matrix Structural Analysis,
    1968). Raises `InputError`: without a section, for a station off the beam, or for a `longest` that is not
    above zero.

    Parameters
    ----------
    stations : sequence of float
        Positions where forces act, m from the left end; each becomes a node.
    longest : float
        No element is longer, m.
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
    starts = zip(sections, ends, strict=False)
    graded = [start + share * part.length for part, start in starts for share in part.grading]
    node = _nodes(ends, [*graded, *(nearest_on(station, length) for station in stations)], longest)
    size = PER_NODE * node.size
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    pieces = []
    for left, right in pairwise(node):
        index = int(np.searchsorted(ends, 0.5 * (left + right), side="right")) - 1
        start, whole = ends[index], sections[index].length
        pieces.append(_Piece(sections[index], float((left - start) / whole), float((right - start) / whole)))
    for k, (m, s) in enumerate(zip(*_coupled(_beam_elements(pieces)), strict=True)):
        rows = slice(PER_NODE * k, PER_NODE * k + 2 * PER_NODE)
        mass[rows, rows] += m
        stiffness[rows, rows] += s
    return TimoshenkoBeam(node, mass, stiffness)


def _nodes(ends: FloatArray, stations: Sequence[float], longest: float) -> FloatArray:
    """Return ends of sections, `stations`, and equal parts between them where these are too long."""
    positions = np.sort(np.concatenate([ends, np.asarray(stations, dtype=float)]))
    apart = np.concatenate([[True], np.diff(positions) > SAME_POSITION * ends[-1]])
    nodes = positions[apart]
    parts = []
    for left, right in pairwise(nodes):
        count = max(math.ceil((right - left) / longest * (1.0 - SAME_POSITION)), 1)
        parts.append(np.linspace(left, right, count, endpoint=False))
    return np.concatenate([*parts, nodes[-1:]])


def _coupled(elements: _ElementMatrices) -> tuple[FloatArray, FloatArray]:
    """Mass and stiffness (k, 12, 12) of elements in all freedoms of their nodes."""
    size = (elements.axial.shape[0], 2 * PER_NODE, 2 * PER_NODE)
    mass, stiffness = np.zeros(size), np.zeros(size)
    # u_x' = tilt_y, u_y' = -tilt_x
    for first, tilt, slope in ((0, 4, 1.0), (1, 3, -1.0)):
        sign = np.array([1.0, slope, 1.0, slope])
        sign = sign[:, None] * sign
        own = np.array([first, tilt, first + PER_NODE, tilt + PER_NODE])
        mass[:, own[:, None], own] = sign * elements.bending_mass
        stiffness[:, own[:, None], own] = sign * elements.bending
    for first, rod_mass, rod in (
        (2, elements.axial_mass, elements.axial),
        (5, elements.torsional_mass, elements.torsion),
    ):
        own = np.array([first, first + PER_NODE])
        mass[:, own[:, None], own], stiffness[:, own[:, None], own] = rod_mass, rod
    return mass, stiffness
