"""Second, independent solver of frictionless contact at many points: an interior-point method in numpy.

For n contacts it finds forces F >= 0 and the deflection d with

    s = C F + lambda(F) + g - m d >= 0,    F_i s_i = 0,    n'F = T,

by following F_i s_i = mu from large mu to zero with damped Newton steps (a monotone complementarity
problem; S. J. Wright, Primal-Dual Interior-Point Methods, SIAM 1997, chapter 7). No active set is kept, no
contact is ever dropped. The local law is written down here from the formulas of K. L. Johnson, Contact
Mechanics, 1985, sections 2.7 and 5.5, for a gap of parabolas from break to break; its slope is taken by
differences and not from any identity. Nothing of fe_contact is imported.
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
    """Gaps s x + q x^2/2 + sum of a d + b d^2/2 between edges low and high (n,); breaks (n, B).

    d is the distance beyond the break, away from x = 0.
    """

    slope: Array
    curvature: Array
    low: Array
    high: Array
    coordinate: Array
    jump: Array
    bend: Array


@dataclass(frozen=True)
class Problem:
    """n contacts; SI units; arrays (n,), compliance (n, n)."""

    compliance: Array
    gap: Array
    motion_arm: Array
    torque_arm: Array
    gap_about: GapAbout
    width: Array
    length: float
    """Reference length of the local law away from free ends. Strips are tabulated for half widths up to 0.66
    of this length."""
    reference_length: Array
    """Reference length of each contact, greater near free ends."""
    modulus: Array


@dataclass(frozen=True)
class _Answer:
    """Deflection in m, forces in N, the largest relative violation of the conditions, and the iterations."""

    deflection: float
    force: Array
    violation: float
    iterations: int


def _pieces(about: GapAbout, center: Array, half: Array) -> tuple[Array, Array, Array]:
    """Means of g', g' sin t and g over the angle of strips, from break to break; shapes (n, ...).

    Between two breaks g is a parabola through its values at the ends and the middle, g' the straight line
    that belongs to it; their integrals against 1 and sin t are elementary.
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
        bend = 2.0 * (g[2] - 2.0 * g[1] + g[0]) / width**2  # g = bend/1 (u - u1)^2 + tilt (u - u1) + g1
        tilt = (g[2] - g[0]) / width
        moment_0, moment_1 = right - left, np.cos(left) - np.cos(right)
        moment_2 = 0.5 * (moment_0 - 0.5 * (np.sin(2.0 * right) - np.sin(2.0 * left)))
        there = sine[2] > sine[0]
        a, b = tilt - 2.0 * bend * sine[1], 2.0 * bend  # dg/du = a + b u
        slope += np.where(there, a * moment_0 + b * moment_1, 0.0)
        first += np.where(there, a * moment_1 + b * moment_2, 0.0)
        constant = g[1] - tilt * sine[1] + bend * sine[1] ** 2
        mean += np.where(there, constant * moment_0 + a * moment_1 + bend * moment_2, 0.0)
    return slope / np.pi / half, first / np.pi / half, mean / np.pi


def _gap_at(about: GapAbout, x: Array) -> Array:
    """Gap in m at x (..., n, ...), the contacts along axis 1."""
    lift = (1, -1) + (1,) * (x.ndim - 2)
    value = about.slope.reshape(lift) * x + 0.5 * about.curvature.reshape(lift) * x**2
    for k in range(about.coordinate.shape[1]):
        position = about.coordinate[:, k].reshape(lift)
        depth = np.maximum(np.where(position >= 0.0, x - position, position - x), 0.0)
        value += about.jump[:, k].reshape(lift) * depth + 0.5 * about.bend[:, k].reshape(lift) * depth**2
    return value


def _root(function: Callable[[Array], Array], low: Array, high: Array, tolerance: Array) -> Array:
    """Zeros between bounds of rising functions, by false position (Illinois); a bound where there is none."""
    at_low, at_high = function(low), function(high)
    bracketed = (at_low >= 0.0) | (at_high <= 0.0)
    middle = np.where(at_low >= 0.0, low, high)
    side = np.zeros(low.shape)
    for _ in range(100):
        change = np.where(at_high > at_low, at_high - at_low, 1.0)
        following = np.where(bracketed, middle, np.clip(high - at_high * (high - low) / change, low, high))
        value = function(following)
        rising = value > 0.0
        at_low = np.where(rising, np.where(side > 0.0, 0.5 * at_low, at_low), value)
        at_high = np.where(rising, value, np.where(side < 0.0, 0.5 * at_high, at_high))
        low, high = np.where(rising, low, following), np.where(rising, following, high)
        settled = bracketed | (np.abs(following - middle) <= tolerance) | (value == 0.0)
        side, middle = np.where(rising, 1.0, -1.0), following
        if np.all(settled):
            break
    return middle


def _strips(problem: Problem, half: Array) -> tuple[Array, Array]:
    """Line load in N/m and mean gap in m of strips of half lengths (n, ...)."""
    about = problem.gap_about
    extra = (1,) * (half.ndim - 1)
    low = np.maximum(-half, about.low.reshape(-1, *extra) + half)
    high = np.maximum(np.minimum(half, about.high.reshape(-1, *extra) - half), low)
    middle = _root(lambda at: _pieces(about, at, half)[0], low, high, 1e-8 * half)
    slope, tilted, mean = _pieces(about, middle, half)
    at_edge = (middle == low) | (middle == high)
    # at a break at the end of the strip both means go with the root of the distance: straight to each other
    below, above = (np.clip(middle + side * 1e-8 * half, low, high) for side in (-1.0, 1.0))
    (under, left, _), (over, right, _) = _pieces(about, below, half), _pieces(about, above, half)
    between = np.where(over > under, over - under, np.inf)
    tilted = np.where(at_edge, tilted + np.abs(slope), left - under * (right - left) / between)
    return 0.5 * np.pi * problem.modulus.reshape(-1, *extra) * half * tilted, mean


class _GuardedLaw:
    """The law from 1e-4 to 0.66 reference lengths of a strip: its secant below, its tangent above.

    Strips are tabulated over their length; between the entries the length is found by the secant method.
    """

    def __init__(self, problem: Problem) -> None:
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
        """Approach in m and slope in m/N between the entries of the table."""
        return self._guarded(force, self._tabulated)

    def __call__(self, force: Array) -> tuple[Array, Array]:
        """Approach in m and slope in m/N under the forces."""
        return self._guarded(force, self._exact)

    def _guarded(self, force: Array, between: Callable[[Array], tuple[Array, Array]]) -> tuple[Array, Array]:
        """Go on straight below and above the table."""
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
        x = _root(
            lambda at: np.log(_strips(self.problem, np.exp(at))[0]) - target, low, high, np.full(p.size, 1e-7)
        )
        _, mean = _strips(self.problem, np.exp(x))
        value = mean + self.k * p * (np.log(self.problem.reference_length / np.exp(x)) - 0.25)
        return value, self._entry(p, self.slope)


def solve(problem: Problem, total: float) -> _Answer:
    """Solve for one load > 0; the answer's `violation` says how well it holds."""
    law, n = _GuardedLaw(problem), problem.gap.size
    motion, torque = problem.motion_arm, problem.torque_arm
    touch = float(np.min(problem.gap / motion))
    gap = problem.gap - touch * motion
    force = np.full(n, total / torque.sum())
    value, _ = law.rough(force)
    unit = float(np.max(problem.compliance @ force + value))  # of lengths; `total` is that of forces
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
        # predictor-corrector with one centring parameter
        target = 0.1 * mu if np.abs(defect).max() / unit < 1e3 * mu / (total * unit) else 0.5 * mu
        matrix = problem.compliance + np.diag(slope + slack / force)
        right = -defect - slack + target / force
        by_motion, by_rest = np.linalg.solve(matrix, np.stack([motion, right], axis=1)).T
        dd = (-equilibrium - torque @ by_rest) / (torque @ by_motion)
        df = by_motion * dd + by_rest
        ds = target / force - slack - slack / force * df
        reach = 1.0
        for x, dx in ((force, df), (slack, ds)):
            shrinking = dx < 0.0
            if shrinking.any():
                reach = min(reach, 0.99 * float(np.min(-x[shrinking] / dx[shrinking])))
        force, slack, d = force + reach * df, slack + reach * ds, d + reach * dd
    return _polished(problem, law, total, touch, gap, force, slack, unit, iterations)


def _balanced(
    problem: Problem,
    law: _GuardedLaw,
    total: float,
    gap: Array,
    force: Array,
    loaded: NDArray[np.bool_],
) -> tuple[Array, float]:
    """Return forces of the loaded contacts that carry the total, and the deflection: Newton's method."""
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


def _polished(
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
    """Solve the equations of the contacts left loaded, and measure every condition on the result.

    The table of the law is good to a few digits: a contact that just touches may be on the wrong side.
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
