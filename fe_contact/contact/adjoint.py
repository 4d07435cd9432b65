"""Derivatives of the contact: the adjoint, the strips that carry, and changes of the flanks under them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.contact.model import GapTerm
from fe_contact.contact.newton import NewtonSystem, empty_system, newton_system
from fe_contact.contact.point_problem import (
    PointProblem,
    PointProblems,
    State,
    approach,
    carrying_strip,
    dot,
    eliminate,
    motion_at,
    point_problems,
    press,
    pressed_state,
    problem_at,
)
from fe_contact.contact.problem import Candidates, ContactProblem
from fe_contact.contact.strip import past_break
from fe_contact.contact.sweep import ContactSolution
from fe_contact.contact.tilted_bodies import yield_to
from fe_contact.contact.touch import rolls_at
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray, IntArray, Status
from host.loops import njit

# Derivatives of the transmission error from the solved contact, by its adjoint.


@dataclass(frozen=True)
class _Adjoint:
    """Influences on the transmission error of P positions at L loads, and their strips; m candidates.

    Attributes
    ----------
    weight : ndarray, shape (P, L, m)
        dSTE per normal approach taken away at each candidate, 1; zero where it does not carry, NaN where the
        contact is not solved. Their sum over the candidates, times `Candidates.motion_arm`, is 1.
    middle, half : ndarray, shape (P, L, m)
        Middle of each contact strip from the touching point on, towards tip 1, and half its length, m.
    tilt : ndarray, shape (P, L, m)
        Of the flanks, and as much again of what else moves: how the weighed motions grow along the flank, 1.
    """

    weight: FloatArray
    middle: FloatArray
    half: FloatArray
    tilt: FloatArray


def adjoint(problem: ContactProblem, solution: ContactSolution) -> _Adjoint:
    """Find the weights of all candidates, and the strips, of a solved problem."""
    weight, middle, half, tilt = np.zeros((4, *solution.force.shape))
    _weigh(point_problems(problem), solution.force, weight, middle, half, tilt)
    weight[solution.status != Status.CONVERGED] = np.nan
    return _Adjoint(weight, middle, half, tilt)


@njit(cache=True, error_model="numpy")
def _weigh(
    every: PointProblems,
    force: FloatArray,
    weight: FloatArray,
    middle: FloatArray,
    half: FloatArray,
    tilt: FloatArray,
) -> None:
    """Fill in the weights and strips of all positions and loads."""
    for p in range(force.shape[0]):
        problem, here = problem_at(every, p)
        for k in range(force.shape[1]):
            weights = _weights(problem, force[p, k][here])
            tilts = _tilts(problem, force[p, k][here], weights)
            for q in range(here.size):
                if force[p, k, here[q]] > 0.0:
                    at = here[q]
                    weight[p, k, at] = weights[q]
                    middle[p, k, at], half[p, k, at] = carrying_strip(
                        problem.law, problem.place[q], force[p, k, at]
                    )
                    tilt[p, k, at] = motion_at(problem, q, tilts)


@njit(cache=True, error_model="numpy")
def _tilts(problem: PointProblem, force: FloatArray, weights: FloatArray) -> FloatArray:
    """Return how fast the weighed motions grow as the place where slices (n,) press moves, per weight there.

    What moves the place itself grows by the tilt of the bodies; what it moves elsewhere by theirs under the
    weights.
    """
    n = problem.bodies.shape[0]
    held, weighed, tilts = np.zeros(n), np.zeros(n), np.zeros(n)
    press(problem, force, held)
    press(problem, weights, weighed)
    for j in range(n if problem.tilt.size else 0):
        if held[j] > 0.0 and weighed[j] > 0.0:
            tilts[j] = dot(problem.tilt[j], held + held[j] / weighed[j] * weighed, n)
    return tilts


@njit(cache=True, error_model="numpy")
def _linearized(problem: PointProblem, force: FloatArray) -> tuple[State, NewtonSystem, int]:
    """Return the state of a solution, and Newton's equations there with their number."""
    state = pressed_state(problem, force)
    for q in range(force.size):
        if force[q] > 0.0:
            state.slope[q] = 1.0 / approach(problem.law, problem.place[q], force[q])[1]
    system = empty_system(problem)
    return state, system, newton_system(problem, state, system)


@njit(cache=True, error_model="numpy")
def _weights(problem: PointProblem, force: FloatArray) -> FloatArray:
    """Return the weights (m,) under the forces of a solution."""
    state, system, size = _linearized(problem, force)
    for r in range(size):
        system.right[0, r] = system.shares[system.member[r]]
    if not eliminate(system.matrix, system.right[:1], size):
        return np.full(force.size, np.nan)
    answer, motion = np.zeros((2, state.held.size))
    for r in range(size):
        answer[system.member[r]] = system.right[0, r]
    yield_to(state.yielding, answer, motion)
    weights, stiff = np.zeros(force.size), 0.0
    for q in range(force.size):
        if state.slope[q] > 0.0:
            weights[q] = state.slope[q] * (problem.torque_arm[q] - motion_at(problem, q, motion))
            stiff += weights[q] * problem.motion_arm[q]
    return weights / stiff


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
    """Fill in the changes of the forces of all positions and loads."""
    for p in range(force.shape[0]):
        problem, here = problem_at(every, p)
        for k in range(force.shape[1]):
            apart = np.ascontiguousarray(opened[:, p, k][:, here])
            answers = _answers(problem, force[p, k][here], apart)
            for a in range(answers.shape[0]):
                for q in range(here.size):
                    changes[a, p, k, here[q]] = answers[a, q]


@njit(cache=True, error_model="numpy")
def _answers(problem: PointProblem, force: FloatArray, opened: FloatArray) -> FloatArray:
    """Return the changes of the forces (A, m): dF = D (m dd - dg - N K dh), dh = y dd - z, n'dF = 0."""
    state, system, size = _linearized(problem, force)
    count, m = opened.shape
    right, rows = np.zeros((count + 1, size)), np.zeros((count + 1, state.held.size))
    right[0] = system.right[0, :size]  # N'D m
    for a in range(count):
        press(problem, state.slope * opened[a], rows[a + 1])
        for r in range(size):
            right[a + 1, r] = rows[a + 1, system.member[r]]
    if not eliminate(system.matrix, right, size):
        return np.full((count, m), np.nan)
    followed, motion, answers = np.zeros((count + 1, m)), np.zeros(state.held.size), np.zeros((count, m))
    for a in range(count + 1):
        rows[a, :] = 0.0
        for r in range(size):
            rows[a, system.member[r]] = right[a, r]
        yield_to(state.yielding, rows[a], motion)
        for q in range(m):
            arm = problem.motion_arm[q] if a == 0 else opened[a - 1, q]
            followed[a, q] = state.slope[q] * (arm - motion_at(problem, q, motion))
    stiff = dot(problem.torque_arm, followed[0], m)
    for a in range(count):
        lag = dot(problem.torque_arm, followed[a + 1], m) / stiff
        answers[a] = lag * followed[0] - followed[a + 1]
    return answers


_NODE = math.sqrt(0.75)
"""Outer ones of three samples in parts of half a strip, the third in its middle."""
_POINTS = 8
"""Of a strip at which a change is spread over the flank."""


@dataclass(frozen=True)
class CarryingStrips:
    """The k strips that carry, of all positions, loads and candidates.

    Attributes
    ----------
    shape : (int, int, int)
        Numbers of positions, loads and candidates.
    index : ndarray of int, shape (k,)
        Of each among all of these, flattened.
    s_1, s_2 : ndarray, shape (k,)
        Flank coordinates of the touching points, m.
    face : ndarray, shape (k,)
        Distance from the pinion's mid-face, m.
    roll_1 : ndarray, shape (k,)
        Roll length of gear 1 on the line of action, m.
    middle, half : ndarray, shape (k,)
        Of the strip from the touching point on, m.
    rolled : ndarray, shape (k,)
        Normal approach taken away per slope of the gap over the strip under a small load, m: the slope
        moves the place where the bodies are pressed.
    rest_middle, rest_half : ndarray, shape (k,)
        Of that strip (`Candidates.strips`), m.
    arm, normal : ndarray, shape (k,), and float
        Normal approach taken away per gap opened on the line of action: at the touching point, and by what
        is removed over the strip beyond that.
    weight : ndarray, shape (k,)
        dSTE per normal approach taken away.
    """

    pair: ParallelAxes
    shape: tuple[int, int, int]
    index: IntArray
    s_1: FloatArray
    s_2: FloatArray
    face: FloatArray
    roll_1: FloatArray
    middle: FloatArray
    half: FloatArray
    rolled: FloatArray
    rest_middle: FloatArray
    rest_half: FloatArray
    arm: FloatArray
    normal: float
    weight: FloatArray

    @classmethod
    def of(cls, pair: ParallelAxes, candidates: Candidates, adjoint: _Adjoint) -> CarryingStrips:
        """Gather them from a solution of these candidates."""
        at = np.nonzero(adjoint.weight)
        strips = adjoint.middle[at], adjoint.half[at], adjoint.tilt[at], adjoint.weight[at]
        return cls.at(pair, candidates, adjoint.weight.shape[1], at, *strips)

    @classmethod
    def at(
        cls,
        pair: ParallelAxes,
        candidates: Candidates,
        loads: int,
        at: tuple[IntArray, ...],
        middle: FloatArray,
        half: FloatArray,
        tilt: FloatArray,
        weight: FloatArray,
    ) -> CarryingStrips:
        """Take k strips at the positions, loads and candidates `at`, of so many loads."""
        p, _, m = at
        touch, strips, shape = (
            candidates.touch,
            candidates.strips,
            (candidates.position.size, loads, candidates.pair.size),
        )
        return cls(
            pair,
            shape,
            np.ravel_multi_index(at, shape),
            touch.s_1[p, m],
            touch.s_2[p, m],
            candidates.face_position[m],
            touch.roll_1[p, m],
            middle,
            half,
            np.where(strips.slope == 0.0, -1.0 / strips.curvature, 0.0)[p, m] * tilt,
            strips.middle[p, m],
            strips.half[p, m],
            candidates.motion_arm[p, m],
            math.cos(candidates.base_helix_angle),
            weight,
        )

    @property
    def row(self) -> IntArray:
        """Position and load of each strip, flattened."""
        return self.index // self.shape[2]

    def opened(self, gap: GapTerm) -> FloatArray:
        """Return the normal approach (k,) in m that a small gap between the flanks takes away.

        Linear in the gap. Between its breaks the gap counts as a parabola over each strip.
        """
        there, mean, _ = self._removed(gap)
        if gap.along_profile and self.rolled.any():
            at_rest = replace(self, middle=self.rest_middle, half=self.rest_half)
            mean = mean + self.rolled * at_rest._removed(gap)[2]
        return np.asarray(self.arm * there + self.normal * (mean - there))

    def change(self, opened: FloatArray) -> FloatArray:
        """Return what normal approach taken away (k,) in m adds to the transmission error, (P, L) in m."""
        rows = self.shape[:2]
        return np.asarray(np.bincount(self.row, self.weight * opened, math.prod(rows)).reshape(rows))

    def _removed(self, gap: GapTerm) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the gap at the touching points and its mean over the strips (k,), m, and the mean slope."""
        if not gap.along_profile:
            mating = self.pair.mating_roll_length(self.roll_1)
            steady = np.asarray(gap(self.pair, self.roll_1, mating, self.face))
            return steady, steady, np.zeros(steady.shape)
        x = self.middle + _NODE * self.half * np.array([[-1.0], [0.0], [1.0]])
        breaks = [(each, each.distance(self.s_1, self.s_2)) for each in gap.breaks(self.pair, self.face)]
        smooth = gap(self.pair, *rolls_at(self.pair, self.s_1 + x, self.s_2 - x), self.face)
        smooth = smooth - sum(each.height(x - distance) for each, distance in breaks)
        slope = (smooth[2] - smooth[0]) / (2.0 * _NODE)
        bend = (smooth[2] - 2.0 * smooth[1] + smooth[0]) / _NODE**2
        back = -self.middle / self.half
        there = smooth[1] + back * (slope + 0.5 * back * bend)
        mean, slope = smooth[1] + 0.25 * bend, slope / self.half
        for each, distance in breaks:
            there = there + each.height(-distance)
            beyond = each.side * (distance - self.middle)  # from the middle to the break
            jump, curved = (np.broadcast_to(value, beyond.shape) for value in (each.jump, each.bend))
            height, rise = _means_past_break(beyond, self.half, jump, curved)
            mean, slope = mean + height, slope + each.side * rise
        return there, mean, slope

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
        """
        angle = np.pi * ((np.arange(_POINTS) + 0.5) / _POINTS - 0.5)
        x = self.middle + self.rolled + self.half * np.sin(angle)[:, None]
        value = np.broadcast_to(self.weight * self.arm / _POINTS, x.shape)
        by_node = np.zeros((len(rows), roll_length.size, face_position.size))
        roll = rolls_at(self.pair, self.s_1 + x, self.s_2 - x)[gear]
        along = np.broadcast_to(self.face - gear * self.pair.axial_offset, x.shape)
        (i, part), (j, other) = _between(roll_length, roll), _between(face_position, along)
        weight = rows.reshape(len(rows), -1)[:, self.row]
        for a, in_roll in ((0, 1.0 - part), (1, part)):
            for b, in_face in ((0, 1.0 - other), (1, other)):
                node = (i + a) * face_position.size + j + b
                part_of_node = value * in_roll * in_face
                for k, each in enumerate(weight):
                    spread = np.bincount(node.ravel(), (each * part_of_node).ravel(), by_node[k].size)
                    by_node[k] += spread.reshape(by_node[k].shape)
        return by_node


@njit(cache=True, error_model="numpy")
def _means_past_break(
    beyond: FloatArray, half: FloatArray, jump: FloatArray, bend: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the means over strips (k,) of jump d + bend d^2/2 past a break in m, and of its slope."""
    height, slope = np.zeros((2, beyond.size))
    for i in range(beyond.size):
        if beyond[i] < half[i]:
            angle, _, ramp, _, square = past_break(beyond[i], half[i])
            height[i] = (jump[i] * ramp + 0.5 * bend[i] * square) / math.pi
            slope[i] = (jump[i] * angle + bend[i] * ramp) / math.pi
    return height, slope


def _between(nodes: FloatArray, at: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the interval of each place, and the part of it that lies before; outside: at an end."""
    i = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, nodes.size - 2)
    return i, np.clip((at - nodes[i]) / (nodes[i + 1] - nodes[i]), 0.0, 1.0)
