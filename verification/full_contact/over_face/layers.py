"""Layers over half the face: hats on their planes, a bubble in each, and integrals of both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.types import FloatArray

_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(3)


@dataclass(frozen=True)
class Layers:
    """Planes from mid-face to the face, p = layers + 1; functions of z >= 0: p hats, then p - 1 bubbles.

    `planes` (p,): rising from 0, m.
    """

    planes: FloatArray

    @property
    def count(self) -> int:
        """Number of layers."""
        return len(self.planes) - 1

    @property
    def quadrature(self) -> tuple[FloatArray, FloatArray]:
        """Positions over half the face and their weights, three in each layer, m."""
        middle, half = 0.5 * (self.planes[1:] + self.planes[:-1]), 0.5 * np.diff(self.planes)
        positions = middle[:, None] + half[:, None] * _GAUSS
        return positions.ravel(), (half[:, None] * _WEIGHTS).ravel()

    def hats(self, z: FloatArray) -> FloatArray:
        """Return the linear hats (q, p) at positions (q,)."""
        return np.stack([np.interp(z, self.planes, hat) for hat in np.eye(len(self.planes))], axis=-1)

    def functions(self, z: FloatArray) -> FloatArray:
        """Return hats and bubbles (q, 2 p - 1) at positions (q,)."""
        hats = self.hats(z)
        return np.concatenate([hats, 4.0 * hats[:, :-1] * hats[:, 1:]], axis=1)

    def slopes(self, z: FloatArray) -> FloatArray:
        """Return their derivatives (q, 2 p - 1) at positions (q,) inside layers, 1/m."""
        hats, layer = self.hats(z), np.searchsorted(self.planes, z) - 1
        rates = np.zeros_like(hats)
        rows, steep = np.arange(len(z)), 1.0 / np.diff(self.planes)[layer]
        rates[rows, layer], rates[rows, layer + 1] = -steep, steep
        bubbles = 4.0 * (rates[:, :-1] * hats[:, 1:] + hats[:, :-1] * rates[:, 1:])
        return np.concatenate([rates, bubbles], axis=1)

    def integrals(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the integrals of f g in m, f' g, and f' g' in 1/m, of all functions f and g."""
        z, weights = self.quadrature
        value, slope = self.functions(z), self.slopes(z)
        weighted = weights[:, None] * value
        return value.T @ weighted, slope.T @ weighted, slope.T @ (weights[:, None] * slope)


def graded_layers(face_width: float, count: int, outermost: float = 0.25) -> Layers:
    """Return layers over half of a face that grow in proportion from the face inwards.

    Parameters
    ----------
    face_width : float
        m.
    count : int
        Over half the face, >= 1.
    outermost : float
        Thickness of the layer at the face over that at mid-face.
    """
    thickness = np.geomspace(1.0, outermost, count) if count > 1 else np.ones(1)
    planes = np.concatenate([[0.0], np.cumsum(thickness)])
    return Layers(0.5 * face_width * planes / planes[-1])
