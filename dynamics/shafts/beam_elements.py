"""Beam elements of varying cross section, from the flexibility of a clamped piece.

A piece is clamped at its left end, and a force and a moment act at its right end. Its flexibility gives the
stiffness matrix, and its deflection along the piece, exact under end loads, the shapes of the mass matrix.
Axis letters: k pieces, p = n Gauss points along a piece, a deflection and rotation, i and j the freedoms of
both ends. `at` are properties at the Gauss points; `inside` those at Gauss points of the part left of each of
them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.shafts.beam_section import BeamSection
from dynamics.types import FloatArray

POINTS = 12
"""Gauss points along an element. Against 60 of them, entries of its matrices are within 5e-13 where diameters
vary by a factor of 2, within 2e-6 at a factor of 4."""


_GAUSS = np.polynomial.legendre.leggauss(POINTS)


_SHARE, _WEIGHT = 0.5 * (1.0 + _GAUSS[0]), 0.5 * _GAUSS[1]


class Piece(NamedTuple):
    """A part of a section: `start` and `end` in shares of its length."""

    section: BeamSection
    start: float
    end: float

    @property
    def length(self) -> float:
        """Length of the part, m."""
        return (self.end - self.start) * self.section.length


class ElementMatrices(NamedTuple):
    """Mass and stiffness of k elements, at their left and then their right ends."""

    bending_mass: FloatArray
    bending: FloatArray
    """`bending_mass`, `bending`: Mass and stiffness in one plane: deflection (m) and its slope (rad). Shape
    (k, 4, 4) each.
    """
    axial_mass: FloatArray
    axial: FloatArray
    torsional_mass: FloatArray
    torsion: FloatArray
    """`axial_mass`, `axial`, `torsional_mass`, `torsion`: Displacement along the axis, m; rotation, rad.
    Shape (k, 2, 2) each.
    """


class _Along(NamedTuple):
    """Stiffnesses and masses per length of k pieces at n points along them, (k, n)."""

    bent: FloatArray
    sheared: FloatArray
    pulled: FloatArray
    twisted: FloatArray
    mass: FloatArray
    diametral: FloatArray


def beam_elements(pieces: Sequence[Piece]) -> ElementMatrices:
    """Return the stiffness and mass matrices of all pieces."""
    length = np.array([piece.length for piece in pieces])
    at, inside = _along(pieces, _SHARE), _along(pieces, np.outer(_SHARE, _SHARE))
    bending_mass, bending = _bending(length, at, inside)
    axial_mass, axial = _rod(length, at.pulled, inside.pulled, at.mass)
    torsional_mass, torsion = _rod(length, at.twisted, inside.twisted, 2.0 * at.diametral)
    return ElementMatrices(bending_mass, bending, axial_mass, axial, torsional_mass, torsion)


def _along(pieces: Sequence[Piece], share: FloatArray) -> _Along:
    """Return the properties at shares (...) of the pieces, (k, ...) each, in the order of `_Along`."""
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


def _bending(length: FloatArray, at: _Along, along: _Along) -> tuple[FloatArray, FloatArray]:
    """Return mass and stiffness (k, 4, 4) in one plane."""
    far = length[:, None] * (1.0 - _SHARE)
    step = length[:, None] * _WEIGHT
    flexibility = _stacked(  # deflection and rotation of the right end per force and moment there
        np.sum(step * (far**2 / at.bent + 1.0 / at.sheared), axis=1),
        np.sum(step * far / at.bent, axis=1),
        np.sum(step * far / at.bent, axis=1),
        np.sum(step / at.bent, axis=1),
    )
    unit, zero = np.ones_like(length), np.zeros_like(length)
    # motion of the right end against a rigid motion with the left end, per freedom: (k, 2, 4)
    relative = np.stack(
        [np.stack([-unit, -length, unit, zero], axis=-1), np.stack([zero, -unit, zero, unit], axis=-1)],
        axis=1,
    )
    clamped = np.linalg.solve(flexibility, relative)  # force and moment at the right end
    stiffness = relative.transpose(0, 2, 1) @ clamped
    s = length[:, None] * _SHARE
    shape = _deflection(length, along) @ clamped[:, None]
    shape[..., 0, 0] += 1.0  # the rigid motion with the left end
    shape[..., 0, 1] += s
    shape[..., 1, 1] += 1.0
    inertia = np.stack([step * at.mass, step * at.diametral], axis=-1)
    mass = np.einsum("kpai,kpa,kpaj->kij", shape, inertia, shape)
    return mass, 0.5 * (stiffness + stiffness.transpose(0, 2, 1))


def _deflection(length: FloatArray, along: _Along) -> FloatArray:
    """Return deflection and rotation at the points per force and moment at the right end, (k, n, 2, 2)."""
    s = length[:, None, None] * _SHARE[:, None]
    t, step = s * _SHARE, s * _WEIGHT
    rest, arm = s - t, length[:, None, None] - t
    return _stacked(
        np.sum(step * (rest * arm / along.bent + 1.0 / along.sheared), axis=-1),
        np.sum(step * rest / along.bent, axis=-1),
        np.sum(step * arm / along.bent, axis=-1),
        np.sum(step / along.bent, axis=-1),
    )


def _rod(
    length: FloatArray, at: FloatArray, inside: FloatArray, mass: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return mass and stiffness (k, 2, 2) of rods in tension or torsion; `at`, `inside`: their rigidity."""
    step = length[:, None] * _WEIGHT
    total = np.sum(step / at, axis=1)
    extension = np.sum(length[:, None, None] * _SHARE[:, None] * _WEIGHT / inside, axis=-1) / total[:, None]
    shape = np.stack([1.0 - extension, extension], axis=-1)
    stiffness = np.array([[1.0, -1.0], [-1.0, 1.0]]) / total[:, None, None]
    return np.einsum("kpi,kp,kpj->kij", shape, step * mass, shape), stiffness


def _stacked(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    return np.stack([np.stack([a, b], axis=-1), np.stack([c, d], axis=-1)], axis=-2)
