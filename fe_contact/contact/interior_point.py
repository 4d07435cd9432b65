"""Second, independent solver of frictionless contact at many points: an interior-point method in numpy.

For n contacts it finds forces F >= 0 and the deflection d with

    s = C F + lambda(F) + g - m d >= 0,    F_i s_i = 0,    n'F = T,

by following F_i s_i = mu from large mu to zero with damped Newton steps (a monotone complementarity
problem; S. J. Wright, Primal-Dual Interior-Point Methods, SIAM 1997, chapter 7). No active set is kept, no
contact is ever dropped. The local law is written down here from the formulas of K. L. Johnson, Contact
Mechanics, 1985, section 4.2 and 5.6, and from the one-sided contact of a half-plane; its slope is taken
analytically from its own expression and not from any identity. Nothing of fe_contact is imported.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Problem:
    """n contacts; SI units; arrays (n,), compliance (n, n); an edge slope of NaN means no edge."""

    compliance: Array
    gap: Array
    motion_arm: Array
    torque_arm: Array
    radius: Array
    edge_slope: Array
    width: Array
    patch_1: Array
    patch_2: Array
    modulus: float
    k1: float
    k2: float


@dataclass(frozen=True)
class Answer:
    """Deflection in m, forces in N, the largest relative violation of the conditions, and the iterations."""

    deflection: float
    force: Array
    violation: float
    iterations: int


def raw_approach(problem: Problem, p: Array) -> tuple[Array, Array]:
    """Approach and its slope in the line load for p > 0, without guards."""
    radius, modulus, phi = problem.radius, problem.modulus, np.nan_to_num(problem.edge_slope, nan=-np.inf)
    b = np.sqrt(4.0 * p * radius / (np.pi * modulus))
    log_b, dlog_b, rigid = np.log(b), 0.5 / p, np.zeros_like(p)
    at_edge = b > -phi * radius
    if at_edge.any():
        r, f, q = radius[at_edge], phi[at_edge], p[at_edge]
        # p = (pi E/4)(phi c + 3c^2/(4R)): the positive root, written so that nothing cancels
        root = np.sqrt(f**2 + 12.0 * q / (np.pi * modulus * r))
        c = np.where(f > 0.0, 8.0 * q / (np.pi * modulus * (root + np.abs(f))), 2.0 * r / 3.0 * (root - f))
        dc = 4.0 / (np.pi * modulus * (f + 1.5 * c / r))
        singular, regular = f + c / (2.0 * r), c / (4.0 * r)
        # mean logarithm of the pressure sqrt((c-x)/x)*singular + sqrt(x(c-x))/R, split by resultants
        mean_log = np.log(c) - 2.0 * np.log(2.0) + (-singular + 0.5 * regular) / (singular + regular)
        top, bottom = -singular + 0.5 * regular, singular + regular
        dmean = 1.0 / c + (-0.375 / r * bottom - 0.75 / r * top) / bottom**2
        log_b[at_edge] = mean_log + 0.5 + np.log(2.0)
        dlog_b[at_edge] = dmean * dc
        rigid[at_edge] = np.where(f < 0.0, 0.5 * f**2 * r, 0.0)
    value = np.zeros_like(p)
    for k, a in ((problem.k1, problem.patch_1), (problem.k2, problem.patch_2)):
        value += k * p * (np.log(a) - log_b + 0.25)
    return value + rigid, value / p - (problem.k1 + problem.k2) * p * dlog_b


def strip_load(problem: Problem, share: float) -> Array:
    """Line load at which half the strip is `share` of the k-weighted mean patch, by bisection."""
    k = problem.k1 + problem.k2
    patch = problem.patch_1 ** (problem.k1 / k) * problem.patch_2 ** (problem.k2 / k)
    low, high = np.full(patch.size, -60.0), np.full(patch.size, 60.0)
    for _ in range(200):
        middle = 0.5 * (low + high)
        wide = half_strip(problem, np.exp(middle)) > share * patch
        low, high = np.where(wide, low, middle), np.where(wide, middle, high)
    return np.asarray(np.exp(0.5 * (low + high)))


def half_strip(problem: Problem, p: Array) -> Array:
    """Half of the contact length: Hertz, or one-sided where the edge cuts the strip off."""
    radius, modulus = problem.radius, problem.modulus
    phi = np.nan_to_num(problem.edge_slope, nan=-1e300)
    b = np.sqrt(4.0 * p * radius / (np.pi * modulus))
    root = np.sqrt(np.where(phi > -1e200, phi, 0.0) ** 2 + 12.0 * p / (np.pi * modulus * radius))
    c = 8.0 * p / (np.pi * modulus) / (root + np.abs(phi))
    c = np.where(phi < 0.0, 2.0 * radius / 3.0 * (root - np.where(phi > -1e200, phi, 0.0)), c)
    return np.asarray(np.where(b > -phi * radius, 0.5 * c, b))


class GuardedLaw:
    """The law with its secant below a strip of 1e-4 patches and straight on above a strip of 0.66 patches."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.low, self.high = strip_load(problem, 1e-4), strip_load(problem, 0.66)
        self.low_value, _ = raw_approach(problem, self.low)
        self.high_value, self.high_slope = raw_approach(problem, self.high)

    def __call__(self, force: Array) -> tuple[Array, Array]:
        """Approach in m and slope in m/N under the forces."""
        p = force / self.problem.width
        value, slope = raw_approach(self.problem, np.clip(p, self.low, self.high))
        value = np.where(p < self.low, self.low_value * p / self.low, value)
        slope = np.where(p < self.low, self.low_value / self.low, slope)
        value = np.where(p > self.high, self.high_value + self.high_slope * (p - self.high), value)
        return value, slope / self.problem.width


def solve(problem: Problem, total: float) -> Answer:
    """Solve for one load > 0; the answer's `violation` says how well it holds."""
    law, n = GuardedLaw(problem), problem.gap.size
    motion, torque = problem.motion_arm, problem.torque_arm
    touch = float(np.min(problem.gap / motion))
    gap = problem.gap - touch * motion
    force = np.full(n, total / torque.sum())
    value, _ = law(force)
    unit = float(np.max(problem.compliance @ force + value))  # lengths are measured by it, forces by `total`
    slack, d = np.full(n, unit), unit
    iterations = 0
    for step in range(1, 401):
        iterations = step
        value, slope = law(force)
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
    return polished(problem, law, total, touch, gap, force, slack, unit, iterations)


def polished(
    problem: Problem,
    law: GuardedLaw,
    total: float,
    touch: float,
    gap: Array,
    force: Array,
    slack: Array,
    unit: float,
    iterations: int,
) -> Answer:
    """Solve the equations of the contacts left loaded, and measure every condition on the result."""
    loaded = force / total > slack / unit
    force = np.where(loaded, force, 0.0)
    motion, torque = problem.motion_arm[loaded], problem.torque_arm[loaded]
    block = problem.compliance[np.ix_(loaded, loaded)]
    d = 0.0
    for _ in range(30):
        value, slope = law(force)
        right = -(problem.compliance @ force + value + gap)[loaded]
        by_motion, by_rest = np.linalg.solve(
            block + np.diag(slope[loaded]), np.stack([motion, right], axis=1)
        ).T
        d = (total - torque @ (force[loaded] + by_rest)) / (torque @ by_motion)
        force[loaded] += by_motion * d + by_rest
    value, _ = law(force)
    slack = problem.compliance @ force + value + gap - problem.motion_arm * d
    violation = max(
        float(np.max(-slack)) / d,
        float(np.max(-force)) / total,
        float(np.max(np.abs(force * slack))) / (total * d),
        abs(float(problem.torque_arm @ force) - total) / total,
    )
    return Answer(touch + d, force, violation, iterations)
