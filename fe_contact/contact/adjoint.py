"""Derivatives of the contact: the adjoint, the strips that carry, and changes of the flanks under them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.contact.elimination import dot, eliminate
from fe_contact.contact.model import GapTerm
from fe_contact.contact.newton import empty_system, newton_system
from fe_contact.contact.point_problem import (
    PointProblem,
    PointProblems,
    approach,
    carrying_strip,
    motions,
    point_problems,
    press,
    pressed_state,
    problem_on,
    row_bodies,
)
from fe_contact.contact.problem import Candidates, ContactProblem
from fe_contact.contact.strip_changes import ClosingLag, FollowingPatches, Strips, TurnedForces
from fe_contact.contact.sweep import ContactSolution
from fe_contact.contact.tilted_bodies import yield_to
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray, IntArray, Status
from host.loops import inner, njit

# Derivatives of transmission error and load arm from the solved contact, by its adjoint.


@dataclass(frozen=True)
class _Adjoint:
    """Influences of m candidates on STE and load arm at P positions and L loads, and the strips."""

    weight: FloatArray
    """dSTE per normal approach taken away at each candidate, 1; zero where it does not carry, NaN where the
    contact is not solved. Their sum over the candidates, times `Candidates.motion_arm`, is 1. Shape (P, L,
    m).
    """
    arm_weight: FloatArray
    """The same of the load arm; of it this sum is 0. Shape (P, L, m)."""
    added_arm: FloatArray
    """Arm of a little more load, m. Shape (P, L)."""
    middle: FloatArray
    half: FloatArray
    """`middle`, `half`: Middle of each contact strip from the touching point on, towards tip 1, and half its
    length, m. Shape (P, L, m) each.
    """


def load_arm(pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> FloatArray:
    """Return the arm of the load about the axis of a misalignment (P, L), m."""
    _, moments = _shares(pair, problem.candidates)
    return np.asarray(np.einsum("plm,pm->pl", solution.force, moments) / solution.load)


def _shares(pair: ParallelAxes, c: Candidates) -> FloatArray:
    """Return the shares of the load per unit force, and these times the arms in m, (2, P, m)."""
    return c.torque_share * np.stack([np.ones(c.gap.shape), pair.tilt_arm(c.touch.roll_1, c.face_position)])


def adjoint(pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> _Adjoint:
    """Find the weights of all candidates, and the strips, of a solved problem.

    With S the fall of the forces as contacts are moved apart by g at one deflection, which is symmetric, n
    the shares of the load, m the normal approach per deflection and z the arms, dF = S (m dSTE - dg) and
    n'dF = 0: the weights of the STE are S n/(n'S m), those of the arm (b S n - S (n z))/load, b being the
    arm of a little more load.
    """
    c = problem.candidates
    pushed, (middle, half) = (np.zeros((2, *solution.force.shape)) for _ in range(2))
    weigh(point_problems(problem), solution.force, _shares(pair, c), pushed, middle, half)
    pushed[:, solution.status != Status.CONVERGED] = np.nan
    stiffness, of_arm = np.einsum("rplm,pm->rpl", pushed, c.motion_arm)
    weight, added_arm = pushed[0] / stiffness[..., None], of_arm / stiffness
    arm_weight = (added_arm[..., None] * pushed[0] - pushed[1]) / solution.load[:, None]
    return _Adjoint(weight, arm_weight, added_arm, middle, half)


@njit(cache=True, error_model="numpy")
def weigh(
    every: PointProblems,
    force: FloatArray,
    shares: FloatArray,
    pushed: FloatArray,
    middle: FloatArray,
    half: FloatArray,
) -> None:
    """Fill in what rows of shares (R, P, m) push, (R, P, L, m), and the strips of all positions and loads."""
    count = every.bodies.shape[0]
    for row in range(count):
        bodies = row_bodies(every, row)
        for p in range(row, force.shape[0], count):
            problem, here = problem_on(every, bodies, p)
            rows = np.ascontiguousarray(shares[:, p][:, here])
            for k in range(force.shape[1]):
                parts = _pushed(problem, force[p, k][here], rows)
                for q in range(here.size):
                    at, carried = here[q], force[p, k, here[q]]
                    pushed[:, p, k, at] = parts[:, q]
                    if carried > 0.0:
                        middle[p, k, at], half[p, k, at] = carrying_strip(problem.law, q, carried)


@inner(error_model="numpy")
def _pushed(problem: PointProblem, force: FloatArray, rows: FloatArray) -> FloatArray:
    """Return by how much forces fall as contacts are moved apart by rows (R, m), at one deflection.

    It is D (1 - N K (1 + N'DN K)^-1 N'D), which is symmetric, about the forces of a solution.
    """
    state = pressed_state(problem, force)
    for q in range(force.size):
        if force[q] > 0.0:
            state.slope[q] = 1.0 / approach(problem.law, q, force[q])[1]
    system = empty_system(problem)
    size = newton_system(problem, state, system)
    held, motion = np.zeros((2, state.held.size))
    right, out = np.zeros((len(rows), size)), np.full(rows.shape, np.nan)
    for a in range(len(rows)):
        press(problem, state.slope * rows[a], held)
        for r in range(size):
            right[a, r] = held[system.member[r]]
    if not eliminate(system.matrix, right, size):
        return out
    for a in range(len(rows)):
        held[:] = 0.0
        for r in range(size):
            held[system.member[r]] = right[a, r]
        yield_to(state.yielding, held, motion)
        out[a] = state.slope * (rows[a] - motions(problem, motion))
    return out


def force_changes(problem: ContactProblem, solution: ContactSolution, opened: FloatArray) -> FloatArray:
    """Return how the forces change as contacts are moved apart, at the same load.

    Parameters
    ----------
    problem, solution
    opened : ndarray, shape (A, P, L, m)
        Normal approach taken away from each candidate by A changes, m; of those that carry.

    Returns
    -------
    ndarray, shape (A, P, L, m)
        N.
    """
    changes = np.zeros(opened.shape)
    _respond(point_problems(problem), solution.force, opened, changes)
    return changes


@njit(cache=True, error_model="numpy")
def _respond(every: PointProblems, force: FloatArray, opened: FloatArray, changes: FloatArray) -> None:
    """Fill in the changes of the forces of all positions and loads: dF = S (m dd - dg), n'dF = 0."""
    count = every.bodies.shape[0]
    for row in range(count):
        bodies = row_bodies(every, row)
        for p in range(row, force.shape[0], count):
            problem, here = problem_on(every, bodies, p)
            rows = np.empty((len(opened) + 1, here.size))
            rows[0] = problem.motion_arm
            for k in range(force.shape[1]):
                rows[1:] = opened[:, p, k][:, here]
                parts = _pushed(problem, force[p, k][here], rows)
                stiff = dot(problem.torque_arm, parts[0], here.size)
                for a in range(len(opened)):
                    lag = dot(problem.torque_arm, parts[a + 1], here.size) / stiff
                    changes[a, p, k][here] = lag * parts[0] - parts[a + 1]


_POINTS = 8
"""Of a strip at which a change is spread over the flank."""


@dataclass(frozen=True)
class CarryingStrips:
    """The k strips that carry, of all positions, loads and candidates."""

    shape: tuple[int, int, int]
    """Numbers of positions, loads and candidates."""
    index: IntArray
    """Of each among all of these, flattened. Shape (k,)."""
    strips: Strips
    closing: ClosingLag
    turned: TurnedForces
    """Of all candidates."""
    following: FollowingPatches | None
    """Of all candidates; None where patches stay."""
    normal: float
    """Normal approach taken away per depth removed in the transverse section."""
    weight: FloatArray
    arm_weight: FloatArray
    """`weight`, `arm_weight`: dSTE, and change of the load arm, per normal approach taken away. Shape (k,)
    each.
    """
    added_arm: FloatArray
    """Arm of a little more load, m. Shape (P, L)."""

    @classmethod
    def of(cls, pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> CarryingStrips:
        """Gather them from a solution of a problem."""
        found = adjoint(pair, problem, solution)
        at = np.nonzero(found.weight)
        turned = TurnedForces.of(pair, problem, solution.force)
        following = FollowingPatches.of(pair, problem, solution.force) if problem.tilt.size else None
        strips = found.middle[at], found.half[at], found.weight[at], found.arm_weight[at], found.added_arm
        return cls._at(pair, problem.candidates, at, (turned, following), *strips)

    def at_edges(self, candidates: Candidates, at: tuple[IntArray, ...], half: float) -> CarryingStrips:
        """Return strips without weight, `half` m long, at positions, loads and candidates of the same."""
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
        places = touch.s_1[p, m], touch.s_2[p, m], touch.roll_1[p, m], candidates.face_position[m]
        under = Strips(pair, *places, middle, half)
        return cls(
            shape,
            np.ravel_multi_index(at, shape),
            under,
            ClosingLag.of(under, candidates, (p, m)),
            *bodies,
            math.cos(candidates.base_helix_angle),
            weight,
            arm_weight,
            added_arm,
        )

    @property
    def row(self) -> IntArray:
        """Position and load of each strip, flattened."""
        return self.index // self.shape[2]

    def opened(self, gap: GapTerm, over: GapTerm) -> FloatArray:
        """Return the normal approach (k,) in m that a gap takes away over another near it.

        Linear in their difference. Between its breaks a gap counts as a parabola over each strip.
        """
        mean, under = self.strips.removed(gap), self.strips.removed(over)
        opened = self.normal * (mean - under) + self.closing.opened(gap, over)
        if gap.along_profile or over.along_profile:
            opened = opened + self.turned.opened(gap, over).ravel()[self.index]
        if self.following is not None and (gap.along_profile or over.along_profile):
            at_rest = self.following.at_rest
            slopes = at_rest.slopes(gap) - at_rest.slopes(over)
            opened = opened + self.following.opened(slopes).ravel()[self.index]
        return np.asarray(opened)

    def change(self, opened: FloatArray) -> FloatArray:
        """Return what normal approach taken away (k,) in m adds to the transmission error, (P, L) in m."""
        return self._by_row(self.weight * opened)

    def arm_change(self, opened: FloatArray) -> FloatArray:
        """Return the same of the load arm, (P, L) in m; places and shares of the contacts stay."""
        return self._by_row(self.arm_weight * opened)

    def _by_row(self, values: FloatArray) -> FloatArray:
        rows = self.shape[:2]
        return np.asarray(np.bincount(self.row, values, math.prod(rows)).reshape(rows))

    def on_flank(
        self, gear: int, roll_length: FloatArray, face_position: FloatArray, rows: FloatArray
    ) -> FloatArray:
        """Return what material removed at each node of a grid on a flank does, bilinear between nodes.

        Parameters
        ----------
        gear : int
            0 is the pinion, 1 the wheel.
        roll_length, face_position : ndarray, shapes (R,), (Z,)
            Increasing, m; face positions count from the gear's own mid-face. What is beyond the outer nodes
            counts to them.
        rows : ndarray, shape (Q, P, L)
            Quantities as sums over positions and loads of the transmission error.

        Returns
        -------
        ndarray, shape (Q, R, Z)
            Change of each quantity per m removed at a node.

        Notes
        -----
        Material removed at a place opens the gap there, and tilts it to either side. Patches follow the
        tilt: this part is a dipole, of either sign.
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
