"""Derivatives of the contact: the adjoint, the strips that carry, and changes of the flanks under them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_contact.contact.elimination import dot, eliminate
from fe_contact.contact.model import Break, GapTerm
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
from fe_contact.contact.strip import means_past_break
from fe_contact.contact.sweep import ContactSolution
from fe_contact.contact.tilted_bodies import yield_to
from fe_contact.contact.touch import rolls_at
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray, IntArray, Status
from host.loops import inner, njit

# Derivatives of transmission error and load arm from the solved contact, by its adjoint.


@dataclass(frozen=True)
class _Adjoint:
    """Influences on transmission error and load arm of P positions at L loads, and the strips; m candidates.

    Attributes
    ----------
    weight : ndarray, shape (P, L, m)
        dSTE per normal approach taken away at each candidate, 1; zero where it does not carry, NaN where the
        contact is not solved. Their sum over the candidates, times `Candidates.motion_arm`, is 1.
    arm_weight : ndarray, shape (P, L, m)
        The same of the load arm; of it this sum is 0.
    added_arm : ndarray, shape (P, L)
        Arm of a little more load, m.
    middle, half : ndarray, shape (P, L, m)
        Middle of each contact strip from the touching point on, towards tip 1, and half its length, m.
    """

    weight: FloatArray
    arm_weight: FloatArray
    added_arm: FloatArray
    middle: FloatArray
    half: FloatArray


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


_NODE = math.sqrt(0.75)
"""Outer ones of three samples in parts of half a strip, the third in its middle."""
_POINTS = 8
"""Of a strip at which a change is spread over the flank."""


@dataclass(frozen=True)
class _Strips:
    """Strips of k contacts, about their touching points.

    Attributes
    ----------
    s_1, s_2 : ndarray, shape (k,)
        Flank coordinates of the touching points, m.
    roll_1 : ndarray, shape (k,)
        Roll length of gear 1 on the line of action, m.
    face : ndarray, shape (k,)
        Distance from the pinion's mid-face, m.
    middle, half : ndarray, shape (k,)
        Of the strip from the touching point on, m.
    """

    pair: ParallelAxes
    s_1: FloatArray
    s_2: FloatArray
    roll_1: FloatArray
    face: FloatArray
    middle: FloatArray
    half: FloatArray

    def removed(self, gap: GapTerm) -> FloatArray:
        """Return the mean of a gap over the strips (k,), m."""
        if not gap.along_profile:
            rolls = self.roll_1, self.pair.mating_roll_length(self.roll_1)
            return np.asarray(gap(self.pair, *rolls, self.face))
        smooth, breaks = self._parted(gap)
        bend = (smooth[2] - 2.0 * smooth[1] + smooth[0]) / _NODE**2
        mean = smooth[1] + 0.25 * bend
        return np.asarray(mean + sum(self._past(*each)[0] for each in breaks))

    def slopes(self, gap: GapTerm) -> FloatArray:
        """Return the mean slope of a gap over the strips (k,)."""
        smooth, breaks = self._parted(gap)
        slope = (smooth[2] - smooth[0]) / (2.0 * _NODE * self.half)
        return np.asarray(slope + sum(each.side * self._past(each, distance)[1] for each, distance in breaks))

    @cached_property
    def _nodes(self) -> tuple[FloatArray, tuple[FloatArray, FloatArray]]:
        """Three places of each strip along the flank (3, k), and the roll lengths there."""
        x = self.middle + self.half * np.array([-_NODE, 0.0, _NODE])[:, None]
        return x, rolls_at(self.pair, self.s_1 + x, self.s_2 - x)

    def _parted(self, gap: GapTerm) -> tuple[FloatArray, list[tuple[Break, FloatArray]]]:
        """Return a gap without its breaks at three places of each strip (3, k); breaks and distances."""
        x, rolls = self._nodes
        breaks = [(each, each.distance(self.s_1, self.s_2)) for each in gap.breaks(self.pair, self.face)]
        of_breaks = sum(each.height(x - distance) for each, distance in breaks)
        return gap(self.pair, *rolls, self.face) - of_breaks, breaks

    def _past(self, start: Break, distance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the means over the strips of what a break removes, m, and of its slope."""
        beyond = start.side * (distance - self.middle)  # from the middle to the break
        jump, bend = (np.broadcast_to(value, beyond.shape) for value in (start.jump, start.bend))
        return means_past_break(beyond, self.half, jump, bend)

    def nodes(
        self, gear: int, roll_length: FloatArray, face_position: FloatArray, x: FloatArray
    ) -> Iterator[tuple[IntArray, FloatArray]]:
        """Yield the four nodes of a grid about places x (X, k) along the flank, and their parts there."""
        roll = rolls_at(self.pair, self.s_1 + x, self.s_2 - x)[gear]
        along = np.broadcast_to(self.face - gear * self.pair.axial_offset, x.shape)
        (i, part), (j, other) = _between(roll_length, roll), _between(face_position, along)
        for a, in_roll in ((0, 1.0 - part), (1, part)):
            for b, in_face in ((0, 1.0 - other), (1, other)):
                yield (i + a) * face_position.size + j + b, in_roll * in_face


@dataclass(frozen=True)
class _FollowingPatches:
    """How patches follow the slope of small gaps, and what motions of the bodies that adds.

    Attributes
    ----------
    problem : ContactProblem
    held : ndarray, shape (P, L, n)
        Forces on the slices, N.
    at_rest : _Strips
        Strips under a small load of all candidates, by which patches follow; k = P m.
    index : ndarray of int, shape (k,)
        Of each among all positions and candidates, flattened.
    way : ndarray, shape (k,)
        Motion of its patch towards tip 1 per slope of the gap, m; patches of a slice move by their mean.
    """

    problem: ContactProblem
    held: FloatArray
    at_rest: _Strips
    index: IntArray
    way: FloatArray

    @classmethod
    def of(cls, pair: ParallelAxes, problem: ContactProblem, force: FloatArray) -> _FollowingPatches:
        """Take those of a solved problem."""
        c, held = problem.candidates, problem.candidates.on_slices(force)
        touch, rest = c.touch, c.strips
        free = (rest.slope == 0.0) & (np.abs(touch.moved) < c.slices.law_length) & np.isfinite(c.gap)
        loaded = np.repeat(held.any(axis=1), c.pair.size // held.shape[2], axis=1)
        at = np.nonzero(free & loaded)
        places = touch.s_1[at], touch.s_2[at], touch.roll_1[at], c.face_position[at[1]]
        at_rest = _Strips(pair, *places, rest.middle[at], rest.half[at])
        way = -math.cos(c.base_helix_angle) / rest.curvature[at]
        return cls(problem, held, at_rest, np.ravel_multi_index(at, c.gap.shape), way)

    def opened(self, slopes: FloatArray) -> FloatArray:
        """Return what normal approach small slopes (k,) take away from the candidates (P, L, m), m."""
        c, moved = self.problem.candidates, np.zeros(self.problem.candidates.gap.shape)
        moved.flat[self.index] = self.way * slopes
        by_slice = c.on_mean(moved)[:, None]
        rolled = by_slice * self._tilts + self._times(by_slice * self.held, back=True)
        return c.at_points(rolled)

    @cached_property
    def _tilts(self) -> FloatArray:
        """Under the forces, (P, L, n)."""
        return self._times(self.held)

    def by_slope(self, weight: FloatArray, rows: FloatArray) -> FloatArray:
        """Return what the slope of a gap at each strip adds (Q, k) to sums `rows` (Q, P, L), m.

        Of the transmission error, to which motions at the candidates add by their `weight` (P, L, m).
        """
        c = self.problem.candidates
        pressed = c.on_slices(weight)
        by_slice = pressed * self._tilts + self.held * self._times(pressed)
        on_slice = np.isfinite(c.gap).reshape(len(c.gap), by_slice.shape[2], -1).sum(axis=2)
        mean = np.einsum("apl,pln->apn", rows, by_slice) / np.maximum(on_slice, 1)
        by_point = np.repeat(mean, c.pair.size // by_slice.shape[2], axis=2)
        return np.asarray(by_point.reshape(len(rows), -1)[:, self.index] * self.way)

    def _times(self, values: FloatArray, *, back: bool = False) -> FloatArray:
        """Return the tilts by forces (P, L, n); `back`: the motions of the others by what is displaced."""
        tilt = self.problem.tilt
        by_pitch = values.reshape(-1, len(tilt), *values.shape[1:])
        how = "qij,tqli->tqlj" if back else "qij,tqlj->tqli"
        return np.asarray(np.einsum(how, tilt, by_pitch, optimize=True)).reshape(values.shape)


@dataclass(frozen=True)
class CarryingStrips:
    """The k strips that carry, of all positions, loads and candidates.

    Attributes
    ----------
    shape : (int, int, int)
        Numbers of positions, loads and candidates.
    index : ndarray of int, shape (k,)
        Of each among all of these, flattened.
    strips : _Strips
    following : _FollowingPatches or None
        Of all candidates; None where patches stay.
    normal : float
        Normal approach taken away per depth removed in the transverse section.
    weight, arm_weight : ndarray, shape (k,)
        dSTE, and change of the load arm, per normal approach taken away.
    added_arm : ndarray, shape (P, L)
        Arm of a little more load, m.
    """

    shape: tuple[int, int, int]
    index: IntArray
    strips: _Strips
    following: _FollowingPatches | None
    normal: float
    weight: FloatArray
    arm_weight: FloatArray
    added_arm: FloatArray

    @classmethod
    def of(cls, pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> CarryingStrips:
        """Gather them from a solution of a problem."""
        found = adjoint(pair, problem, solution)
        at = np.nonzero(found.weight)
        following = _FollowingPatches.of(pair, problem, solution.force) if problem.tilt.size else None
        strips = found.middle[at], found.half[at], found.weight[at], found.arm_weight[at], found.added_arm
        return cls._at(pair, problem.candidates, at, following, *strips)

    def at_edges(self, candidates: Candidates, at: tuple[IntArray, ...], half: float) -> CarryingStrips:
        """Return strips without weight, `half` m long, at positions, loads and candidates of the same."""
        zero = np.zeros(at[0].size)
        strips = zero, zero + half, zero, zero, self.added_arm
        return self._at(self.strips.pair, candidates, at, self.following, *strips)

    @classmethod
    def _at(
        cls,
        pair: ParallelAxes,
        candidates: Candidates,
        at: tuple[IntArray, ...],
        following: _FollowingPatches | None,
        middle: FloatArray,
        half: FloatArray,
        weight: FloatArray,
        arm_weight: FloatArray,
        added_arm: FloatArray,
    ) -> CarryingStrips:
        p, _, m = at
        touch, shape = candidates.touch, (*added_arm.shape, candidates.pair.size)
        places = touch.s_1[p, m], touch.s_2[p, m], touch.roll_1[p, m], candidates.face_position[m]
        return cls(
            shape,
            np.ravel_multi_index(at, shape),
            _Strips(pair, *places, middle, half),
            following,
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
        opened = self.normal * (mean - under)
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
        if self.following is not None:
            by_point, rest = np.zeros(self.shape), self.following.at_rest
            by_point.flat[self.index] = self.weight
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


def _between(nodes: FloatArray, at: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the interval of each place, and the part of it that lies before; outside: at an end."""
    i = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, nodes.size - 2)
    return i, np.clip((at - nodes[i]) / (nodes[i + 1] - nodes[i]), 0.0, 1.0)
