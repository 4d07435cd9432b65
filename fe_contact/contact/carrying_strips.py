"""Changes of transmission error and load arm by changes of the flanks under loaded strips."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.contact.adjoint import adjoint
from fe_contact.contact.model import GapTerm
from fe_contact.contact.problem import Candidates, ContactProblem
from fe_contact.contact.strip_changes import ClosingLag, FollowingPatches, Strips, TurnedForces
from fe_contact.contact.sweep import ContactSolution
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray, IntArray

_POINTS = 8
"""Points of a strip at which a change of the flanks is sampled."""


@dataclass(frozen=True)
class CarryingStrips:
    """The k strips under load, of all positions, loads and candidates."""

    shape: tuple[int, int, int]
    """Numbers of positions, loads and candidates."""
    index: IntArray
    """Index of each strip among all positions, loads and candidates, flattened. Shape (k,)."""
    strips: Strips
    closing: ClosingLag
    turned: TurnedForces
    """Changes of the bodies' displacements by turned forces, at all candidates."""
    following: FollowingPatches | None
    """Motions of the load patches, of all candidates; None where patches stay."""
    normal: float
    """Normal approach taken away per depth removed in the transverse section."""
    weight: FloatArray
    arm_weight: FloatArray
    """`weight`, `arm_weight`: dSTE, and change of the load arm, per normal approach taken away. Shape (k,)
    each.
    """
    added_arm: FloatArray
    """Arm of a small further load, m. Shape (P, L)."""

    @classmethod
    def of(cls, pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> CarryingStrips:
        """Return the strips under load in a solution of a problem."""
        weights = adjoint(pair, problem, solution)
        at = np.nonzero(weights.weight)
        turned = TurnedForces.of(pair, problem, solution.force)
        following = FollowingPatches.of(pair, problem, solution.force) if problem.tilt.size else None
        strips = (
            weights.middle[at],
            weights.half[at],
            weights.weight[at],
            weights.arm_weight[at],
            weights.added_arm,
        )
        return cls._at(pair, problem.candidates, at, (turned, following), *strips)

    def at_edges(self, candidates: Candidates, at: tuple[IntArray, ...], half: float) -> CarryingStrips:
        """Return strips of the half length `half` in m, at other positions, loads and candidates.

        They add nothing to sums: their `weight` and `arm_weight` are zero.
        """
        zero = np.zeros(at[0].size)
        strips = zero, zero + half, zero, zero, self.added_arm
        return self._at(self.strips.pair, candidates, at, (self.turned, self.following), *strips)

    @classmethod
    def _at(
        cls,
        pair: ParallelAxes,
        candidates: Candidates,
        at: tuple[IntArray, ...],
        bodies: tuple[TurnedForces, FollowingPatches | None],
        middle: FloatArray,
        half: FloatArray,
        weight: FloatArray,
        arm_weight: FloatArray,
        added_arm: FloatArray,
    ) -> CarryingStrips:
        p, _, m = at
        touch, shape = candidates.touch, (*added_arm.shape, candidates.pair.size)
        touching = touch.s_1[p, m], touch.s_2[p, m], touch.roll_1[p, m], candidates.face_position[m]
        strips = Strips(pair, *touching, middle, half)
        turned, following = bodies
        return cls(
            shape=shape,
            index=np.ravel_multi_index(at, shape),
            strips=strips,
            closing=ClosingLag.of(strips, candidates, (p, m)),
            turned=turned,
            following=following,
            normal=math.cos(candidates.base_helix_angle),
            weight=weight,
            arm_weight=arm_weight,
            added_arm=added_arm,
        )

    @property
    def row(self) -> IntArray:
        """Position and load of each strip, flattened."""
        return self.index // self.shape[2]

    def opened(self, gap: GapTerm, over: GapTerm) -> FloatArray:
        """Return the normal approach (k,) in m that a gap takes away, less that of another near it.

        It is linear in their difference. Between its breaks a gap counts as a parabola over each strip.
        """
        depth = self.strips.removed(gap) - self.strips.removed(over)
        opened = self.normal * depth + self.closing.opened(gap, over)
        if gap.along_profile or over.along_profile:
            opened = opened + self.turned.opened(gap, over).ravel()[self.index]
        if self.following is not None and (gap.along_profile or over.along_profile):
            at_rest = self.following.at_rest
            slopes = at_rest.slopes(gap) - at_rest.slopes(over)
            opened = opened + self.following.opened(slopes).ravel()[self.index]
        return np.asarray(opened)

    def change(self, opened: FloatArray) -> FloatArray:
        """Return the change (P, L) of the transmission error by normal approach (k,) taken away, m."""
        return self._by_row(self.weight * opened)

    def arm_change(self, opened: FloatArray) -> FloatArray:
        """Return the change of the load arm (P, L) by normal approach (k,) taken away, both in m.

        The contacts keep their positions on the flank and their shares of the load.
        """
        return self._by_row(self.arm_weight * opened)

    def _by_row(self, values: FloatArray) -> FloatArray:
        rows = self.shape[:2]
        return np.asarray(np.bincount(self.row, values, math.prod(rows)).reshape(rows))

    def on_flank(
        self, gear: int, roll_length: FloatArray, face_position: FloatArray, rows: FloatArray
    ) -> FloatArray:
        """Return derivatives by material removed at each node of a grid on a flank, bilinear between nodes.

        Parameters
        ----------
        gear : int
            0 is the pinion, 1 the wheel.
        roll_length, face_position : ndarray, shapes (R,), (Z,)
            Increasing, m; face positions count from the gear's own mid-face. Material beyond the outer nodes
            counts as removed at them.
        rows : ndarray, shape (Q, P, L)
            Factors of the transmission errors at positions and loads, whose weighted sums are the quantities.

        Returns
        -------
        ndarray, shape (Q, R, Z)
            Change of each quantity per m removed at a node.

        Notes
        -----
        Material removed at a point opens the gap there, and tilts it on both sides of the point. Patches move
        with the tilt: the derivative by that is a dipole, positive on one side and negative on the other.
        """
        angle = np.pi * ((np.arange(_POINTS) + 0.5) / _POINTS - 0.5)
        x = self.strips.middle + self.strips.half * np.sin(angle)[:, None]
        by_node = np.zeros((len(rows), roll_length.size * face_position.size))
        weight = rows.reshape(len(rows), -1)[:, self.row] * (self.weight * self.normal / _POINTS)
        for node, part in self.strips.nodes(gear, roll_length, face_position, x):
            _spread(weight, node, part, by_node)
        weight = rows.reshape(len(rows), -1)[:, self.row] * self.weight
        for node, part in self.closing.nodes(gear, roll_length, face_position):
            _spread(weight, node, part, by_node)
        by_point = np.zeros(self.shape)
        by_point.flat[self.index] = self.weight
        for of in (0, 1):
            by_slope, closing = self.turned.by_slope(of, by_point, rows), self.turned.closing
            for node, slope in closing.slope_nodes(of, gear, roll_length, face_position):
                _spread(by_slope, node, slope, by_node)
        if self.following is not None:
            rest = self.following.at_rest
            dipole = self.following.by_slope(by_point, rows) / (2.0 * rest.half)
            for side in (1.0, -1.0):
                x = rest.middle + side * rest.half
                for node, part in rest.nodes(gear, roll_length, face_position, x):
                    _spread(side * dipole, node, part, by_node)
        return by_node.reshape(len(rows), roll_length.size, face_position.size)


def _spread(values: FloatArray, node: IntArray, part: FloatArray, by_node: FloatArray) -> None:
    """Add `part` (..., k) of values (Q, k) to nodes (..., k) of Q grids, flattened."""
    for k, value in enumerate(values):
        by_node[k] += np.bincount(node.ravel(), (value * part).ravel(), by_node.shape[1])
