"""A strip of flank as a curve of quadratic pieces, and the points where normals of one strip meet another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fe_contact.types import FloatArray, IntArray

_STEPS = 12


class CurvePoints(NamedTuple):
    """Points of a curve: places (q, 2) and derivatives (q, 2), m; node numbers and weights (q, 3)."""

    at: FloatArray
    slope: FloatArray
    nodes: IntArray
    weights: FloatArray

    @property
    def tangents(self) -> FloatArray:
        """Unit tangents towards the tip, (q, 2)."""
        return np.asarray(self.slope / np.linalg.norm(self.slope, axis=1, keepdims=True))

    @property
    def normals(self) -> FloatArray:
        """Outward unit normals, (q, 2)."""
        return np.asarray(self.tangents[:, ::-1] * [1.0, -1.0])


@dataclass(frozen=True)
class FlankCurve:
    """Quadratic pieces through nodes (2 e + 1, 2), m, towards the tip; piece i has parameters i to i + 1."""

    nodes: FloatArray

    @property
    def pieces(self) -> int:
        """Number of pieces."""
        return len(self.nodes) // 2

    def points(self, t: FloatArray) -> CurvePoints:
        """Evaluate at parameters (q,); beyond the ends the last piece goes on."""
        first = np.clip(np.floor(t).astype(np.int64), 0, self.pieces - 1)
        x = t - first
        weights = np.stack([(1.0 - x) * (1.0 - 2.0 * x), 4.0 * x * (1.0 - x), x * (2.0 * x - 1.0)], axis=-1)
        slopes = np.stack([4.0 * x - 3.0, 4.0 - 8.0 * x, 4.0 * x - 1.0], axis=-1)
        nodes = 2 * first[:, None] + np.arange(3)
        at = np.einsum("qa,qax->qx", weights, self.nodes[nodes])
        return CurvePoints(at, np.einsum("qa,qax->qx", slopes, self.nodes[nodes]), nodes, weights)

    def met_along(self, origins: FloatArray, tangents: FloatArray) -> FloatArray:
        """Return the parameters at which this curve meets the normals of another one.

        Parameters
        ----------
        origins, tangents : (q, 2) arrays
            Points of the other curve and its unit tangents, which point the other way along.

        Returns
        -------
        (q,) array
            NaN where a normal passes the curve by.
        """
        corners = self.nodes[::2]
        ahead = np.einsum("qcx,qx->qc", corners[None] - origins[:, None], tangents)
        piece = np.count_nonzero(ahead > 0.0, axis=1) - 1
        hit = (piece >= 0) & (ahead[:, -1] <= 0.0)
        t = np.clip(piece, 0, self.pieces - 1) + 0.5
        for _ in range(_STEPS):
            points = self.points(t)
            value = np.einsum("qx,qx->q", points.at - origins, tangents)
            t = t - value / np.einsum("qx,qx->q", points.slope, tangents)
            t = np.clip(t, piece, piece + 1.0)
        return np.where(hit, t, np.nan)

    def foot_of(self, others: FloatArray, reference: FlankCurve) -> FloatArray:
        """Return the curve parameters whose normals, or those of `reference`, pass through points (q, 2)."""
        corners = np.arange(self.pieces + 1.0)
        tangents = reference.points(corners).tangents
        ahead = np.einsum("qcx,cx->qc", others[:, None] - self.nodes[None, ::2], tangents)
        piece = np.clip(np.count_nonzero(ahead > 0.0, axis=1) - 1, 0, self.pieces - 1)
        t = piece + 0.5
        for _ in range(_STEPS):
            points = self.points(t)
            tangents = reference.points(t).tangents
            step = np.einsum("qx,qx->q", others - points.at, tangents)
            step = step / np.einsum("qx,qx->q", points.slope, tangents)
            t = np.clip(t + step, piece - 1.0, piece + 2.0)
        return np.asarray(t)
