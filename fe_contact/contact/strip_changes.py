"""Changes of the normal approach of contacts by small changes of the flanks.

A strip is the width over which a loaded contact touches, about its touching point. A depth is material
removed from a flank. A lag is the turn of gear 2, along the line of action, that closes the rigid flanks. A
small change of the gap acts in four ways: by its mean depth over the strip (`Strips`), by the lag
(`ClosingLag`), by the motion of load patches (`FollowingPatches`), and by the turn of forces
(`TurnedForces`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from fe_contact.contact.flank_slope import flank_slope, rolls_at
from fe_contact.contact.model import Break, GapTerm
from fe_contact.contact.problem import Candidates, ContactProblem
from fe_contact.contact.strip import means_past_break
from fe_contact.contact.touch import STEP
from fe_contact.geometry import ParallelAxes
from fe_contact.types import BoolArray, FloatArray, IntArray

_NODE = math.sqrt(0.75)
"""Distance of the two outer samples of a strip from the third one in its middle, over half the strip."""
_AT_TOUCH = 1e-3
"""Step of the differences that move touching points, over the step of those that turn normals."""


@dataclass(frozen=True)
class Strips:
    """Strips of k contacts, about their touching points."""

    pair: ParallelAxes
    s_1: FloatArray
    s_2: FloatArray
    """`s_1`, `s_2`: Flank coordinates of the touching points, m. Shape (k,) each."""
    roll_1: FloatArray
    """Roll length of gear 1 on the line of action, m. Shape (k,)."""
    face: FloatArray
    """Distance from the pinion's mid-face, m. Shape (k,)."""
    middle: FloatArray
    half: FloatArray
    """`middle`, `half`: Middle of the strip from the touching point, and half its length, m. Shape (k,)."""

    def removed(self, gap: GapTerm) -> FloatArray:
        """Return the mean of a gap over the strips (k,), m."""
        if not gap.along_profile:
            rolls = self.roll_1, self.pair.mating_roll_length(self.roll_1)
            return np.asarray(gap(self.pair, *rolls, self.face))
        smooth, breaks = self._parted(gap)
        bend = (smooth[2] - 2.0 * smooth[1] + smooth[0]) / _NODE**2
        mean = smooth[1] + 0.25 * bend
        return np.asarray(mean + sum(self._past(*line)[0] for line in breaks))

    def slopes(self, gap: GapTerm) -> FloatArray:
        """Return the mean slope of a gap over the strips (k,)."""
        smooth, breaks = self._parted(gap)
        slope = (smooth[2] - smooth[0]) / (2.0 * _NODE * self.half)
        past_breaks = [(line.side, self._past(line, distance)) for line, distance in breaks]
        return np.asarray(slope + sum(side * slope_past for side, (_, slope_past) in past_breaks))

    @cached_property
    def _nodes(self) -> tuple[FloatArray, tuple[FloatArray, FloatArray]]:
        """Distances of three samples of each strip from its touching point (3, k), m, and rolls there."""
        x = self.middle + self.half * np.array([-_NODE, 0.0, _NODE])[:, None]
        return x, rolls_at(self.pair, self.s_1 + x, self.s_2 - x)

    def _parted(self, gap: GapTerm) -> tuple[FloatArray, list[tuple[Break, FloatArray]]]:
        """Return a gap without its breaks at the samples of each strip (3, k), and the breaks.

        With each break comes its distance (k,) in m from the touching point.
        """
        x, rolls = self._nodes
        breaks = [(line, line.distance(self.s_1, self.s_2)) for line in gap.breaks(self.pair, self.face)]
        beyond_breaks = sum(line.height(x - distance) for line, distance in breaks)
        return gap(self.pair, *rolls, self.face) - beyond_breaks, breaks

    def _past(self, start: Break, distance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the means over the strips of the material that a break removes, m, and of its slope."""
        from_middle = start.side * (distance - self.middle)
        jump, bend = (np.broadcast_to(value, from_middle.shape) for value in (start.jump, start.bend))
        return means_past_break(from_middle, self.half, jump, bend)

    def nodes(
        self, gear: int, roll_length: FloatArray, face_position: FloatArray, x: FloatArray
    ) -> Iterator[tuple[IntArray, FloatArray]]:
        """Yield the four grid nodes about each point and their weights in a linear interpolation (X, k).

        The points are at distances x (X, k) in m from the touching points along the flank of a gear.
        """
        roll = rolls_at(self.pair, self.s_1 + x, self.s_2 - x)[gear]
        face = np.broadcast_to(self.face - gear * self.pair.axial_offset, x.shape)
        (i, roll_part), (j, face_part) = _between(roll_length, roll), _between(face_position, face)
        for a, roll_weight in ((0, 1.0 - roll_part), (1, roll_part)):
            for b, face_weight in ((0, 1.0 - face_part), (1, face_part)):
                yield (i + a) * face_position.size + j + b, roll_weight * face_weight


@dataclass(frozen=True)
class ClosingLag:
    """Normal approach taken away by small gaps, beyond their mean depth over the strips.

    Small gaps change the lag that closes the rigid flanks.
    """

    strips: Strips
    """Strips of k contacts."""
    excess: FloatArray
    """Normal approach taken away per depth removed at the touching point, less that depth. Shape (k,)."""
    lag: FloatArray
    """Lag of gear 2 per slope of its flank (`flank_slope`), m. Shape (k,)."""
    way: FloatArray
    """Motion of the touching point per slope of the gap, m; zero at an edge or a break. Shape (k,)."""
    at_break: BoolArray
    """Whether the touching point is at a break, and moves with it. Shape (k,)."""
    turns: tuple[FloatArray, FloatArray]
    """Change of the slope of either flank per motion of the touching point, 1/m. Shape (k,) each."""

    @classmethod
    def of(cls, strips: Strips, candidates: Candidates, at: tuple[IntArray, ...]) -> ClosingLag:
        """Return the closing lag of candidates at positions and numbers (k,)."""
        touch, arm = candidates.touch, candidates.motion_arm[at]
        lag = arm * np.where(touch.low[at] < 0.0, touch.gap[at] * touch.lag[at], 0.0)
        near_break = (np.abs(touch.offset[at]) < _AT_TOUCH * STEP * touch.radius[at][:, None]).any(axis=1)
        free = touch.slope[at] == 0.0
        way = np.where(free & ~near_break, -1.0 / touch.curvature[at], 0.0)
        at_break = near_break & ~free
        excess = arm * touch.lag[at] - math.cos(candidates.base_helix_angle)
        return cls(strips, excess, lag, way, at_break, (touch.turn_1[at], touch.turn_2[at]))

    def opened(self, gap: GapTerm, over: GapTerm) -> FloatArray:
        """Return how much more normal approach (k,) in m a gap takes away by the lag than the gap `over`."""
        if gap.along_profile or over.along_profile:
            return self.excess * self._change(gap, over, 0.0) + self.lag * self.slope(1, gap, over)
        roll = self.strips.roll_1
        nominal = roll, self.strips.pair.mating_roll_length(roll)
        return self.excess * self._difference(gap, over, nominal)

    def slope(self, gear: int, gap: GapTerm, over: GapTerm) -> FloatArray:
        """Return how much steeper the flank of a gear is by a gap than by the gap `over` near it (k,)."""
        coordinates, difference = (self.strips.s_1, self.strips.s_2), partial(self._difference, gap, over)
        steeper = flank_slope(self.strips.pair, gear, difference, coordinates, self._step)
        return np.asarray(steeper + self.turns[gear] * self._shift(gap, over))

    def _shift(self, gap: GapTerm, over: GapTerm) -> FloatArray:
        """Return the motions of the touching points (k,), m; points at breaks move with the breaks."""
        strips, near = self.strips, _AT_TOUCH * self._step
        slope = (self._change(gap, over, near) - self._change(gap, over, -near)) / (2.0 * near)
        shift = self.way * slope
        breaks, breaks_before = gap.breaks(strips.pair, strips.face), over.breaks(strips.pair, strips.face)
        if len(breaks) != len(breaks_before):
            return np.asarray(shift)  # a relief of zero depth has no break at which a point could stay
        for line, line_before in zip(breaks, breaks_before, strict=True):
            after, before = (term.distance(strips.s_1, strips.s_2) for term in (line, line_before))
            shift = np.where(self.at_break & (np.abs(before) < near), after - before, shift)
        return np.asarray(shift)

    def nodes(
        self, gear: int, roll_length: FloatArray, face_position: FloatArray
    ) -> Iterator[tuple[IntArray, FloatArray]]:
        """Yield nodes (k,) of a grid on a gear, and the normal approach taken away per depth at each."""
        at_touching_points = np.zeros((1, self.excess.size))
        for node, part in self.strips.nodes(gear, roll_length, face_position, at_touching_points):
            yield node[0], self.excess * part[0]
        for node, slope in self.slope_nodes(1, gear, roll_length, face_position):
            yield node, self.lag * slope

    def slope_nodes(
        self, of: int, gear: int, roll_length: FloatArray, face_position: FloatArray
    ) -> Iterator[tuple[IntArray, FloatArray]]:
        """Yield nodes (k,) of a grid on a gear, and the slope of the flank of gear `of` per depth there."""
        strips, pair = self.strips, self.strips.pair
        per_step = 0.5 * self.turns[of] * self.way / self._step
        if of == gear:
            toothing, roll = (pair.pinion, pair.wheel)[of], rolls_at(pair, strips.s_1, strips.s_2)[of]
            steeper = 0.5 * roll / (self._step * toothing.base_radius)
            per_step = per_step + steeper * (1.0 if of == 0 else -1.0)
        for side in (1.0, -1.0):  # of the central difference
            for node, part in strips.nodes(gear, roll_length, face_position, (side * self._step)[None]):
                yield node[0], side * per_step * part[0]

    @cached_property
    def _step(self) -> FloatArray:
        """Step along the flank for numerical derivatives (k,), m."""
        strips, path = self.strips, self.strips.pair.path_of_contact
        return STEP / strips.pair.relative_curvature(np.clip(strips.roll_1, path.start, path.end))

    def _change(self, gap: GapTerm, over: GapTerm, x: FloatArray | float) -> FloatArray:
        """Return a gap less another at distances x (k,) in m from the touching points, m."""
        strips = self.strips
        return self._difference(gap, over, rolls_at(strips.pair, strips.s_1 + x, strips.s_2 - x))

    def _difference(self, gap: GapTerm, over: GapTerm, rolls: tuple[FloatArray, FloatArray]) -> FloatArray:
        pair, face = self.strips.pair, self.strips.face
        return np.asarray(gap(pair, *rolls, face) - over(pair, *rolls, face))


@dataclass(frozen=True)
class FollowingPatches:
    """Load patches that move with the slopes of small gaps, and the changes by their motion."""

    problem: ContactProblem
    slice_force: FloatArray
    """Forces on the slices, N. Shape (P, L, n)."""
    at_rest: Strips
    """Strips of all candidates under a small load, which the patches follow; k = P m."""
    index: IntArray
    """Index of each strip among all positions and candidates, flattened. Shape (k,)."""
    way: FloatArray
    """Motion of a patch towards tip 1 per slope of the gap, m; a slice has their mean. Shape (k,)."""

    @classmethod
    def of(cls, pair: ParallelAxes, problem: ContactProblem, force: FloatArray) -> FollowingPatches:
        """Return the moving patches of a solved problem."""
        c, pressed = problem.candidates, problem.candidates.on_slices(force)
        touch, rest = c.touch, c.strips
        free = (rest.slope == 0.0) & (np.abs(touch.shift) < c.slices.law_length) & np.isfinite(c.gap)
        loaded = np.repeat(pressed.any(axis=1), c.pair.size // pressed.shape[2], axis=1)
        at = np.nonzero(free & loaded)
        touching = touch.s_1[at], touch.s_2[at], touch.roll_1[at], c.face_position[at[1]]
        at_rest = Strips(pair, *touching, rest.middle[at], rest.half[at])
        way = -math.cos(c.base_helix_angle) / rest.curvature[at]
        return cls(problem, pressed, at_rest, np.ravel_multi_index(at, c.gap.shape), way)

    def opened(self, slopes: FloatArray) -> FloatArray:
        """Return the normal approach that small slopes (k,) take away from the candidates (P, L, m), m."""
        c = self.problem.candidates
        shift = np.zeros(c.gap.shape)
        shift.flat[self.index] = self.way * slopes
        by_slice = c.on_mean(shift)[:, None]
        rolled = by_slice * self._tilts + self._times(by_slice * self.slice_force, back=True)
        return c.at_points(rolled)

    @cached_property
    def _tilts(self) -> FloatArray:
        """Tilts of the flanks under the forces (P, L, n)."""
        return self._times(self.slice_force)

    def by_slope(self, weight: FloatArray, rows: FloatArray) -> FloatArray:
        """Return the changes (Q, k) of Q sums per slope of the gap at each strip, m.

        A sum adds up transmission errors at positions and loads by its factors in `rows` (Q, P, L); each
        error is the sum of the motions at the candidates by their `weight` (P, L, m).
        """
        c = self.problem.candidates
        pressed = c.on_slices(weight)
        by_slice = pressed * self._tilts + self.slice_force * self._times(pressed)
        by_point = _at_points(c, np.einsum("apl,pln->apn", rows, by_slice))
        return np.asarray(by_point.reshape(len(rows), -1)[:, self.index] * self.way)

    def _times(self, values: FloatArray, *, back: bool = False) -> FloatArray:
        """Return the tilts by forces (P, L, n); with `back`, sums of values by the transposed tilts."""
        return _times(self.problem.tilt, values, back=back)


@dataclass(frozen=True)
class TurnedForces:
    """Changes of the displacements of bodies by forces that turn with the slopes of small gaps."""

    problem: ContactProblem
    slice_force: FloatArray
    displacement: FloatArray
    """`slice_force`, `displacement`: Forces on the slices, N, and their displacements, m. Shape (P, L, n)."""
    closing: ClosingLag
    """Lag of the k candidates whose slices carry."""
    index: IntArray
    """Index of each candidate among all positions and candidates, flattened. Shape (k,)."""

    @classmethod
    def of(cls, pair: ParallelAxes, problem: ContactProblem, force: FloatArray) -> TurnedForces:
        """Return the turned forces of a solved problem."""
        c, pressed = problem.candidates, problem.candidates.on_slices(force)
        loaded = np.repeat(pressed.any(axis=1), c.pair.size // pressed.shape[2], axis=1)
        at = np.nonzero(loaded & np.isfinite(c.gap))
        zero = np.zeros(at[0].size)
        touching = c.touch.s_1[at], c.touch.s_2[at], c.touch.roll_1[at], c.face_position[at[1]]
        closing = ClosingLag.of(Strips(pair, *touching, zero, zero), c, at)
        index = np.ravel_multi_index(at, c.gap.shape)
        return cls(problem, pressed, _times(problem.bodies, pressed), closing, index)

    def opened(self, gap: GapTerm, over: GapTerm) -> FloatArray:
        """Return how much more normal approach (P, L, m) in m a gap takes away than the gap `over`."""
        c = self.problem.candidates
        slope_1, slope_2 = np.zeros((2, *c.gap.shape))
        slope_1.flat[self.index] = self.closing.slope(0, gap, over)
        slope_2.flat[self.index] = self.closing.slope(1, gap, over)
        turned = self.problem.turned_by(c.on_mean(slope_1), c.on_mean(slope_2))[:, None]
        motion = turned * self.displacement + _times(self.problem.bodies, turned * self.slice_force)
        return c.at_points(motion)

    def by_slope(self, gear: int, weight: FloatArray, rows: FloatArray) -> FloatArray:
        """Return the changes (Q, k) of Q sums per slope of a gear's flank, m.

        The k slopes are those at the candidates of `index`; for `weight` and `rows` see
        `FollowingPatches.by_slope`.
        """
        pressed = self.problem.candidates.on_slices(weight)
        by_slice = pressed * self.displacement + self.slice_force * _times(self.problem.bodies, pressed)
        slopes = np.zeros((2, len(weight), by_slice.shape[2]))
        slopes[gear] = 1.0
        mean = np.einsum("apl,pln->apn", rows, by_slice) * self.problem.turned_by(*slopes)
        return _at_points(self.problem.candidates, mean).reshape(len(rows), -1)[:, self.index]


def _at_points(c: Candidates, by_slice: FloatArray) -> FloatArray:
    """Return each candidate's part (Q, P, m) in values (Q, P, n) for the mean of a slice's candidates."""
    on_slice = np.isfinite(c.gap).reshape(len(c.gap), by_slice.shape[2], -1).sum(axis=2)
    return np.repeat(by_slice / np.maximum(on_slice, 1), c.pair.size // by_slice.shape[2], axis=2)


def _times(matrices: FloatArray, values: FloatArray, *, back: bool = False) -> FloatArray:
    """Return matrices (Q, n, n), or `back` transposed, times values (P, L, n), P a multiple of Q."""
    by_pitch = values.reshape(-1, len(matrices), *values.shape[1:])
    subscripts = "qij,tqli->tqlj" if back else "qij,tqlj->tqli"
    return np.asarray(np.einsum(subscripts, matrices, by_pitch, optimize=True)).reshape(values.shape)


def _between(nodes: FloatArray, coordinate: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the interval of nodes around each coordinate, and the part of it before the coordinate, 0 to 1.

    A coordinate outside the nodes counts as the nearest end.
    """
    i = np.clip(np.searchsorted(nodes, coordinate, side="right") - 1, 0, nodes.size - 2)
    return i, np.clip((coordinate - nodes[i]) / (nodes[i + 1] - nodes[i]), 0.0, 1.0)
