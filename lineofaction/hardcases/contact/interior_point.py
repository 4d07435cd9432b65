"""Second, independent solver of frictionless contact at many points: an interior-point method in numpy.

For n contacts it finds forces F >= 0 and the deflection d with

    s = C F + lambda(F) + g - m d >= 0,    F_i s_i = 0,    t'F = T,

with the gaps s under load (the slacks), the compliance C, the approach lambda of each contact by its local
law, the unloaded gaps g, the motion arms m, the torque arms t and the total load T. It follows F_i s_i = mu
from large mu to zero with damped Newton steps (a monotone complementarity problem; S. J. Wright, Primal-Dual
Interior-Point Methods, SIAM 1997, chapter 7). All contacts stay in the equations; there is no active set.

The local law follows the formulas of K. L. Johnson, Contact Mechanics, 1985, sections 2.7 and 5.5, for a gap
of parabolas from break to break. The contact of a strip touches along a half length a, over which the angle t
runs from -pi/2 to pi/2 (x = center + a sin t). The slope of the law is taken by differences, so that it rests
on no identity. Nothing of fe_contact is imported.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class GapAbout:
    """Unloaded gaps about the touching points of n contacts, with B breaks each.

    At x a gap is slope x + curvature x^2/2 + sum of (jump d + bend d^2/2) over the breaks, with the distance
    d beyond a break, away from x = 0.
    """

    slope: Array
    curvature: Array
    """`slope`, `curvature`: Slope and curvature at x = 0. Shape (n,) each."""
    low: Array
    high: Array
    """`low`, `high`: Edges between which the flanks lie, m. Shape (n,) each."""
    coordinate: Array
    """Coordinates x of the breaks, m. Shape (n, B)."""
    jump: Array
    bend: Array
    """`jump`, `bend`: Changes of slope and curvature at the breaks. Shape (n, B) each."""


@dataclass(frozen=True)
class Problem:
    """n contacts in SI units. Arrays have the shape (n,) unless they say otherwise."""

    compliance: Array
    """Displacement of each contact by unit forces on all of them, without the local law. Shape (n, n)."""
    gap: Array
    """Unloaded gaps at the touching points."""
    motion_arm: Array
    """Closing of each gap by a unit deflection."""
    torque_arm: Array
    """Part of the total load by a unit force on each contact."""
    gap_about: GapAbout
    width: Array
    """Width of the slice of each contact along the face."""
    length: float
    """Reference length of the local law away from free ends. Strips are tabulated for half widths up to 0.66
    of this length."""
    reference_length: Array
    """Reference length of each contact, greater near free ends."""
    modulus: Array
    """Contact modulus E* of each contact."""


@dataclass(frozen=True)
class _Answer:
    """Deflection in m, forces in N, the largest relative violation of the conditions, and the iterations."""

    deflection: float
    force: Array
    violation: float
    iterations: int


def _pieces(about: GapAbout, center: Array, half: Array) -> tuple[Array, Array, Array]:
    """Return the means of g', g' sin t and g over the angle of strips, (n, ...) each.

    Between two breaks the gap g is the parabola through its values at both ends and in the middle, and its
    slope g' is a straight line. Their integrals times 1 and sin t are elementary.
    """
    extra = (1,) * (center.ndim - 1)
    angle = [np.full(center.shape, -0.5 * np.pi), np.full(center.shape, 0.5 * np.pi)]
    for k in range(about.coordinate.shape[1]):
        position = about.coordinate[:, k].reshape(-1, *extra)
        angle.append(np.arcsin(np.clip((position - center) / half, -1.0, 1.0)))
    bounds = np.sort(np.stack(angle), axis=0)
    slope, first, mean = np.zeros((3, *center.shape))
    for left, right in pairwise(bounds):
        sine = np.stack([np.sin(left), 0.5 * (np.sin(left) + np.sin(right)), np.sin(right)])
        g = _gap_at(about, center + half * sine)
        width = np.where(sine[2] > sine[0], sine[2] - sine[0], 1.0)
        # with u = sin t and u1 in the middle: g = bend (u - u1)^2 + tilt (u - u1) + g1
        bend = 2.0 * (g[2] - 2.0 * g[1] + g[0]) / width**2
        tilt = (g[2] - g[0]) / width
        # the same by powers of u: g = constant + a u + bend u^2, dg/du = a + b u
        a, b = tilt - 2.0 * bend * sine[1], 2.0 * bend
        constant = g[1] - tilt * sine[1] + bend * sine[1] ** 2
        # integrals of powers 0 to 2 of u over t
        moment_0, moment_1 = right - left, np.cos(left) - np.cos(right)
        moment_2 = 0.5 * (moment_0 - 0.5 * (np.sin(2.0 * right) - np.sin(2.0 * left)))
        has_width = sine[2] > sine[0]  # two breaks beyond an end of the strip fall together there
        slope += np.where(has_width, a * moment_0 + b * moment_1, 0.0)
        first += np.where(has_width, a * moment_1 + b * moment_2, 0.0)
        mean += np.where(has_width, constant * moment_0 + a * moment_1 + bend * moment_2, 0.0)
    return slope / np.pi / half, first / np.pi / half, mean / np.pi


def _gap_at(about: GapAbout, x: Array) -> Array:
    """Return the gap in m at x (m, n, ...), with the contacts along axis 1."""
    by_contact = (1, -1) + (1,) * (x.ndim - 2)  # shape of an array over contacts beside x
    value = about.slope.reshape(by_contact) * x + 0.5 * about.curvature.reshape(by_contact) * x**2
    for k in range(about.coordinate.shape[1]):
        position = about.coordinate[:, k].reshape(by_contact)
        jump, bend = about.jump[:, k].reshape(by_contact), about.bend[:, k].reshape(by_contact)
        distance = np.maximum(np.where(position >= 0.0, x - position, position - x), 0.0)
        value += jump * distance + 0.5 * bend * distance**2
    return value


def _root(function: Callable[[Array], Array], low: Array, high: Array, tolerance: Array) -> Array:
    """Return the zeros of rising functions between bounds, by false position (Illinois).

    A function without a zero between them gets the bound nearer to it.
    """
    at_low, at_high = function(low), function(high)
    without_zero = (at_low >= 0.0) | (at_high <= 0.0)
    middle = np.where(at_low >= 0.0, low, high)
    side = np.zeros(low.shape)
    for _ in range(100):
        change = np.where(at_high > at_low, at_high - at_low, 1.0)
        false_position = np.clip(high - at_high * (high - low) / change, low, high)
        following = np.where(without_zero, middle, false_position)
        value = function(following)
        rising = value > 0.0
        # a bound that stays for a second time counts half, which brings the next position to its side
        at_low = np.where(rising, np.where(side > 0.0, 0.5 * at_low, at_low), value)
        at_high = np.where(rising, value, np.where(side < 0.0, 0.5 * at_high, at_high))
        low, high = np.where(rising, low, following), np.where(rising, following, high)
        settled = without_zero | (np.abs(following - middle) <= tolerance) | (value == 0.0)
        side, middle = np.where(rising, 1.0, -1.0), following
        if np.all(settled):
            break
    return middle


def _strips(problem: Problem, half: Array) -> tuple[Array, Array]:
    """Return line load in N/m and mean gap in m of strips of half lengths (n, ...).

    A strip settles where the mean of g' over its angle is zero; at an edge of the flank it cannot.
    """
    about = problem.gap_about
    extra = (1,) * (half.ndim - 1)
    # bounds of the middle of a strip: it contains the touching point and ends within the edges
    low = np.maximum(-half, about.low.reshape(-1, *extra) + half)
    high = np.maximum(np.minimum(half, about.high.reshape(-1, *extra) - half), low)
    middle = _root(lambda center: _pieces(about, center, half)[0], low, high, 1e-8 * half)
    slope, tilted, mean = _pieces(about, middle, half)
    at_edge = (middle == low) | (middle == high)
    # Where a strip ends at a break, the means of g' and g' sin t both vary with the root of the distance to
    # the break, so linearly with each other: the second is interpolated to where the first is zero.
    below, above = (np.clip(middle + side * 1e-8 * half, low, high) for side in (-1.0, 1.0))
    slope_below, tilted_below, _ = _pieces(about, below, half)
    slope_above, tilted_above, _ = _pieces(about, above, half)
    change = np.where(slope_above > slope_below, slope_above - slope_below, np.inf)  # inf: they do not vary
    at_zero = tilted_below - slope_below * (tilted_above - tilted_below) / change
    tilted = np.where(at_edge, tilted + np.abs(slope), at_zero)
    return 0.5 * np.pi * problem.modulus.reshape(-1, *extra) * half * tilted, mean


class _GuardedLaw:
    """The local law for half strips from 1e-4 to 0.66 reference lengths.

    Under smaller loads the law is a straight line from the origin, under larger ones it goes on along a
    straight line. Strips are tabulated over their half lengths. Between the entries `rough` interpolates, and
    a call of the law finds the strip.
    """

    def __init__(self, problem: Problem) -> None:
        # under a line load p a half strip a gives way by the mean gap + k p (ln(reference length / a) - 1/4)
        self.problem, self.k = problem, 2.0 / (np.pi * problem.modulus)
        widest = 0.5 * (problem.gap_about.high - problem.gap_about.low)
        first = np.full(widest.size, np.log(1e-4 * problem.length))
        last = np.log(np.minimum(0.66 * problem.length, widest))
        self.half = np.exp(first[:, None] + (last - first)[:, None] * np.linspace(0.0, 1.0, 129))
        self.load, mean = _strips(problem, self.half)
        reference = problem.reference_length[:, None]
        self.value = mean + self.k[:, None] * self.load * (np.log(reference / self.half) - 0.25)
        self.slope = np.stack([np.gradient(v, p) for v, p in zip(self.value, self.load, strict=True)])
        self.beyond = self.k * (np.log(problem.reference_length / self.half[:, -1]) - 0.25)

    def rough(self, force: Array) -> tuple[Array, Array]:
        """Return approach in m and slope in m/N under forces, interpolated in the table."""
        return self._guarded(force, self._tabulated)

    def __call__(self, force: Array) -> tuple[Array, Array]:
        """Return approach in m and slope in m/N under forces, the approach of the exact strips."""
        return self._guarded(force, self._exact)

    def _guarded(self, force: Array, between: Callable[[Array], tuple[Array, Array]]) -> tuple[Array, Array]:
        """Return approach and slope: by `between` inside the table, by straight lines below and above it."""
        p = force / self.problem.width
        low, high = self.load[:, 0], self.load[:, -1]
        value, slope = between(np.clip(p, low, high))
        secant = self.value[:, 0] / low
        value, slope = np.where(p < low, secant * p, value), np.where(p < low, secant, slope)
        value = np.where(p > high, self.value[:, -1] + self.beyond * (p - high), value)
        return value, np.where(p > high, self.beyond, slope) / self.problem.width

    def _tabulated(self, p: Array) -> tuple[Array, Array]:
        return self._entry(p, self.value), self._entry(p, self.slope)

    def _entry(self, p: Array, values: Array) -> Array:
        """Interpolate one quantity of the table at line loads (n,)."""
        rows = zip(p, self.load, values, strict=True)
        return np.array([np.interp(at, load, row) for at, load, row in rows])

    def _exact(self, p: Array) -> tuple[Array, Array]:
        """Find the strips between two entries of the table."""
        target, rows = np.log(p), np.arange(p.size)
        above = np.array([np.searchsorted(load, at) for at, load in zip(p, self.load, strict=True)])
        above = np.clip(above, 1, self.half.shape[1] - 1)
        low, high = np.log(self.half[rows, above - 1]), np.log(self.half[rows, above])

        def load_difference(logarithm: Array) -> Array:
            load, _ = _strips(self.problem, np.exp(logarithm))
            return np.asarray(np.log(load) - target)

        half = np.exp(_root(load_difference, low, high, np.full(p.size, 1e-7)))
        _, mean = _strips(self.problem, half)
        value = mean + self.k * p * (np.log(self.problem.reference_length / half) - 0.25)
        return value, self._entry(p, self.slope)


def solve(problem: Problem, total: float) -> _Answer:
    """Solve for one load > 0; `violation` of the answer is the largest error of the conditions."""
    law, n = _GuardedLaw(problem), problem.gap.size
    motion, torque = problem.motion_arm, problem.torque_arm
    touch = float(np.min(problem.gap / motion))  # deflection at which the first contact touches
    gap = problem.gap - touch * motion
    force = np.full(n, total / torque.sum())
    value, _ = law.rough(force)
    unit = float(np.max(problem.compliance @ force + value))  # scale of lengths; that of forces is `total`
    slack, d = np.full(n, unit), unit
    iterations = 0
    for step in range(1, 401):
        iterations = step
        value, slope = law.rough(force)
        defect = problem.compliance @ force + value + gap - motion * d - slack
        equilibrium = torque @ force - total
        mu = float(force @ slack) / n
        if mu < 1e-14 * total * unit and np.abs(defect).max() < 1e-12 * unit + 1e-14 * gap.max():
            break
        # the target of F_i s_i: a tenth of mu, or half of it while the gaps do not close as mu falls
        is_centered = np.abs(defect).max() / unit < 1e3 * mu / (total * unit)
        target = 0.1 * mu if is_centered else 0.5 * mu
        matrix = problem.compliance + np.diag(slope + slack / force)
        right = -defect - slack + target / force
        by_motion, by_rest = np.linalg.solve(matrix, np.stack([motion, right], axis=1)).T
        dd = (-equilibrium - torque @ by_rest) / (torque @ by_motion)
        df = by_motion * dd + by_rest
        ds = target / force - slack - slack / force * df
        step_length = 1.0  # a step stays inside F > 0 and s > 0
        for x, dx in ((force, df), (slack, ds)):
            falls = dx < 0.0
            if falls.any():
                step_length = min(step_length, 0.99 * float(np.min(-x[falls] / dx[falls])))
        force, slack, d = force + step_length * df, slack + step_length * ds, d + step_length * dd
    return _polished_answer(problem, law, total, touch, gap, force, slack, unit, iterations)


def _balanced(
    problem: Problem,
    law: _GuardedLaw,
    total: float,
    gap: Array,
    force: Array,
    loaded: NDArray[np.bool_],
) -> tuple[Array, float]:
    """Return the forces of the loaded contacts under the total load, and the deflection (Newton)."""
    motion, torque = problem.motion_arm[loaded], problem.torque_arm[loaded]
    block = problem.compliance[np.ix_(loaded, loaded)]
    force, d = force.copy(), 0.0
    for _ in range(30):
        value, slope = law(force)
        right = -(problem.compliance @ force + value + gap)[loaded]
        by_motion, by_rest = np.linalg.solve(
            block + np.diag(slope[loaded]), np.stack([motion, right], axis=1)
        ).T
        d = (total - torque @ (force[loaded] + by_rest)) / (torque @ by_motion)
        change = by_motion * d + by_rest
        force[loaded] += change
        if np.abs(change).max() < 1e-14 * total:
            break
    return force, float(d)


def _polished_answer(
    problem: Problem,
    law: _GuardedLaw,
    total: float,
    touch: float,
    gap: Array,
    force: Array,
    slack: Array,
    unit: float,
    iterations: int,
) -> _Answer:
    """Solve the equations of the loaded contacts by the exact law, and measure every condition on the result.

    By the table of the law, which is good to a few digits, a contact that just touches may be on the wrong
    side. So contacts with a pull leave the loaded ones, and contacts that overlap join them.
    """
    loaded = force / total > slack / unit
    for _ in range(10):
        force, d = _balanced(problem, law, total, gap, np.where(loaded, force, 0.0), loaded)
        value, _ = law(np.maximum(force, 0.0))
        slack = problem.compliance @ force + value + gap - problem.motion_arm * d
        sides = np.where(loaded, force > 0.0, slack < -1e-14 * unit)
        if np.array_equal(sides, loaded):
            break
        loaded = sides
    value, _ = law(force)
    slack = problem.compliance @ force + value + gap - problem.motion_arm * d
    violation = max(
        float(np.max(-slack)) / d,
        float(np.max(-force)) / total,
        float(np.max(np.abs(force * slack))) / (total * d),
        abs(float(problem.torque_arm @ force) - total) / total,
    )
    return _Answer(touch + d, force, violation, iterations)
