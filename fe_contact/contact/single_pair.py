"""Deflection of one pair of teeth that carries the whole load alone: a bound of the deflection of a mesh.

Of all distributions of force that balance the torque, the true one has the least complementary energy. One
of them is an even force along the contact line of one pair. Its energy is F G + W, with the load F, the gap G
of the pair and the strain energy W. The least energy is also the integral of the transmission error d over
the load. Contacts stiffen under load, so d is concave and the integral is at least F (d_0 + d)/2, with d_0
the transmission error without load. Hence

    d <= 2 G - d_0 + 2 W/F.

Axes of arrays: Q positions of the compliance, J pairs of teeth, m candidates (points where teeth can touch;
m/J each pair), n slices of the face, L loads.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.contact.local_law import LARGEST_STRIP
from fe_contact.contact.problem import ContactProblem
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import half_width
from fe_contact.types import BoolArray, FloatArray

LEAST_LOGARITHM = math.log(1.0 / LARGEST_STRIP)
"""Logarithm of the reference length over the half strip where the strip is so wide that the local law is a
straight line.
"""

SHORTEST_LINE = 1e-3
"""Length of the contact line of a pair over the width of a candidate. A shorter line counts as this long, so
that the line load of a pair off the line of action is finite.
"""


def single_pair_deflection(pair: ParallelAxes, problem: ContactProblem, load: FloatArray) -> FloatArray:
    """Return 2 W/F of the stiffest pair alone under the whole load (Q, L), m; infinite where there is none.

    The gaps of the flanks are left out. `load` holds normal forces (L,) in N.
    """
    usable = _on_line(pair, problem, float(load.max()))
    pairs = _SinglePairs.of(problem, usable)
    approach = np.where(pairs.length[..., None] > 0.0, pairs.strain(load), np.inf)
    # from the normal of the flanks to the transverse line of action
    return np.asarray(approach.min(axis=1) / math.cos(problem.candidates.base_helix_angle))


@dataclass(frozen=True)
class _SinglePairs:
    """Even forces on the contact line of each pair, which carries the whole load alone."""

    problem: ContactProblem
    share: FloatArray
    """Part of the load on each candidate of a pair; the sum is 1, or 0 without a line. Shape (Q, J, m/J)."""
    length: FloatArray
    """Length of the contact lines, m; 0 where the pair is not on the line of action. Shape (Q, J)."""

    @classmethod
    def of(cls, problem: ContactProblem, usable: BoolArray) -> _SinglePairs:
        """Lay even forces on the `usable` candidates (Q, m)."""
        candidates = problem.candidates
        pairs = np.unique(candidates.pair).size
        # candidates may repeat the Q positions in further base pitches: the first Q rows are enough
        width = np.where(usable, candidates.width[: len(usable)], 0.0).reshape(len(usable), pairs, -1)
        length = width.sum(axis=2)
        share = np.divide(width, length[..., None], out=np.zeros(width.shape), where=length[..., None] > 0.0)
        return cls(problem, share, length)

    def strain(self, load: FloatArray) -> FloatArray:
        """Return twice the strain energy over the load (Q, J, L), m, at normal forces (L,) in N."""
        return self._body_compliance()[..., None] * load + self._strip_approach(load)

    def _body_compliance(self) -> FloatArray:
        """Return the deflection of the bodies per load (Q, J), m/N."""
        positions, pairs, count = self.share.shape
        force = np.zeros((positions, pairs, pairs, count))
        diagonal = np.arange(pairs)
        force[:, diagonal, diagonal] = self.share  # load case j presses on the candidates of pair j alone
        on_slices = self.problem.candidates.on_slices(force.reshape(positions, pairs, -1))  # (Q, J, n)
        bodies = self.problem.bodies  # (Q, n, n)
        return np.asarray(np.einsum("qjn,qnk,qjk->qj", on_slices, bodies, on_slices, optimize=True))

    def _strip_approach(self, load: FloatArray) -> FloatArray:
        """Return twice the strain energy of the contact strips over the load (Q, J, L), m.

        At the line load p a strip yields by k p [ln(l/b) + 1/2], with the softness k of the half planes of
        both gears, the reference length l and the half strip b.
        """
        problem, shape = self.problem, self.share.shape
        softness = sum(problem.half_planes)  # of both gears
        k = np.broadcast_to(softness, (shape[0], shape[1] * shape[2])).reshape(shape)
        radius = problem.candidates.radius[: shape[0]].reshape(shape)
        line = np.divide(1.0, self.length, out=np.zeros(self.length.shape), where=self.length > 0.0)
        line_load = line[..., None, None] * load
        strip = half_width(line_load, radius[..., None], problem.modulus)
        with np.errstate(divide="ignore"):
            logarithm = np.log(problem.law_length.reshape(shape)[..., None] / strip)
        # b grows with the root of p, so 2/p times the integral of p [ln(l/b) + 1/4] dp is p [ln(l/b) + 1/2]
        factor = np.maximum(logarithm, LEAST_LOGARITHM) + 0.5
        factor = np.where(line_load > 0.0, factor, 0.0)
        return np.asarray(np.einsum("qjm,qjm,qjml->qjl", self.share, k, line_load * factor, optimize=True))


def _on_line(pair: ParallelAxes, problem: ContactProblem, load: float) -> BoolArray:
    """Return which candidates (Q, m) touch on the line of action, their strips clear of the edges."""
    count, candidates = len(problem.compliance), problem.candidates
    touch = candidates.touch.rows(np.arange(count))
    # a lever arm other than the base radius (1) belongs to contact at a tip edge, off the line of action
    on_line = np.isfinite(touch.gap) & (touch.lever_1 == 1.0) & (touch.lever_2 == 1.0)
    roll_2 = pair.mating_roll_length(touch.roll_1)
    usable = on_line & (touch.roll_1 <= pair.pinion.tip_form_roll_length)
    # along a ring gear (sign -1) the roll length decreases towards the tip
    usable &= pair.wheel.sign * (roll_2 - pair.wheel.tip_form_roll_length) <= 0.0
    width = candidates.width[:count]
    pairs = np.unique(candidates.pair).size
    length = np.where(usable, width, 0.0).reshape(count, pairs, -1).sum(axis=2)
    line = np.maximum(length, width.max() * SHORTEST_LINE)  # (Q, J)
    line_load = load / np.repeat(line, width.shape[1] // pairs, axis=1)  # (Q, m)
    strip = half_width(line_load, candidates.radius[:count], problem.modulus)
    to_edge = np.minimum(-touch.low, touch.high)  # the flanks end at `low` < 0 and at `high` > 0
    return np.asarray(usable & (to_edge >= strip))
