"""Deflection of one pair of teeth that carries the whole load alone: a bound of the deflection of a mesh.

The energy of an elastic contact is the least of all forces that balance the torque (complementary energy).
Forces even over one pair are among these: with its gap G, its strain energy W and the load F their energy is
F G + W. The energy is also the integral of the transmission error d over the load, and as contacts stiffen, d
is concave: F (d_0 + d)/2 <= F G + W, so that

    d <= 2 G - d_0 + 2 W/F,    d_0 without load.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.contact.problem import ContactProblem
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import half_width
from fe_contact.types import BoolArray, FloatArray

NARROWEST = math.log(1.0 / 0.66)
"""Logarithm of reference length over half strip below which the local law is a straight line."""


def single_pair_deflection(pair: ParallelAxes, problem: ContactProblem, load: FloatArray) -> FloatArray:
    """Return 2 W/F of the stiffest pair alone under the whole load (Q, L), m; infinite where there is none.

    At the Q positions of the compliance and normal forces (L,) in N, without the gaps of the flanks.
    """
    usable = _on_line(pair, problem, float(load.max()))
    alone = _SinglePairs.of(problem, usable)
    strain = np.where(alone.length[..., None] > 0.0, alone.strain(load), np.inf)
    return np.asarray(strain.min(axis=1) / math.cos(problem.candidates.base_helix_angle))


@dataclass(frozen=True)
class _SinglePairs:
    """Even forces on each pair alone, at the Q positions of a compliance: J pairs of m/J candidates."""

    problem: ContactProblem
    share: FloatArray
    """Part of the force on each candidate; sums to 1 where there are any. Shape (Q, J, m/J)."""
    length: FloatArray
    """Length of the contact lines, m; 0 where the pair is not on the line of action. Shape (Q, J)."""

    @classmethod
    def of(cls, problem: ContactProblem, usable: BoolArray) -> _SinglePairs:
        """Lay even forces on the `usable` candidates (Q, m)."""
        candidates = problem.candidates
        pairs = np.unique(candidates.pair).size
        width = np.where(usable, candidates.width[: len(usable)], 0.0).reshape(len(usable), pairs, -1)
        length = width.sum(axis=2)
        share = np.divide(width, length[..., None], out=np.zeros(width.shape), where=length[..., None] > 0.0)
        return cls(problem, share, length)

    def strain(self, load: FloatArray) -> FloatArray:
        """Return twice the strain energy over the load (Q, J, L), m, at normal forces (L,) in N."""
        return self._bodies()[..., None] * load + self._strips(load)

    def _bodies(self) -> FloatArray:
        """Return the deflection of the bodies per load (Q, J), m/N."""
        q, pairs, count = self.share.shape
        force = np.zeros((q, pairs, pairs, count))
        numbers = np.arange(pairs)
        force[:, numbers, numbers] = self.share
        pressed = self.problem.candidates.on_slices(force.reshape(q, pairs, -1))
        return np.asarray(np.einsum("qjn,qnk,qjk->qj", pressed, self.problem.bodies, pressed, optimize=True))

    def _strips(self, load: FloatArray) -> FloatArray:
        """Return the approach of strips (Q, J, L), m: 2/p times int k p [ln(l/b) + 1/4] dp."""
        problem, shape = self.problem, self.share.shape
        k = np.broadcast_to(sum(problem.half_planes), (shape[0], shape[1] * shape[2])).reshape(shape)
        radius = problem.candidates.radius[: shape[0]].reshape(shape)
        line = np.divide(1.0, self.length, out=np.zeros(self.length.shape), where=self.length > 0.0)
        line_load = line[..., None, None] * load
        strip = half_width(line_load, radius[..., None], problem.modulus)
        with np.errstate(divide="ignore"):
            depth = np.maximum(np.log(problem.law_length.reshape(shape)[..., None] / strip), NARROWEST) + 0.5
        depth = np.where(line_load > 0.0, depth, 0.0)
        return np.asarray(np.einsum("qjm,qjm,qjml->qjl", self.share, k, line_load * depth, optimize=True))


def _on_line(pair: ParallelAxes, problem: ContactProblem, load: float) -> BoolArray:
    """Return which candidates (Q, m) touch on the line of action, their strips clear of the edges."""
    count, candidates = len(problem.compliance), problem.candidates
    touch = candidates.touch.rows(np.arange(count))
    on_line = np.isfinite(touch.gap) & (touch.lever_1 == 1.0) & (touch.lever_2 == 1.0)
    roll_2 = pair.mating_roll_length(touch.roll_1)
    usable = on_line & (touch.roll_1 <= pair.pinion.tip_form_roll_length)
    usable &= pair.wheel.sign * (roll_2 - pair.wheel.tip_form_roll_length) <= 0.0
    width = candidates.width[:count]
    pairs = np.unique(candidates.pair).size
    length = np.where(usable, width, 0.0).reshape(count, pairs, -1).sum(axis=2)
    of_point = np.repeat(np.maximum(length, width.max() * 1e-3), width.shape[1] // pairs, axis=1)
    strip = half_width(load / of_point, candidates.radius[:count], problem.modulus)
    return np.asarray(usable & (np.minimum(-touch.low, touch.high) >= strip))
