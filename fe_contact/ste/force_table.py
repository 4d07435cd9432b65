"""Tables of forces over transmission errors: levels, cubics and pieces.

A level is a mesh force whose transmission error (deflection) is stored over position. Between two levels the
force is a monotone cubic of the deflection, a piece. Above the highest level the force is the straight line
with the stiffness of that level. Slopes are derivatives by position. Q queries are evaluated at once.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bounds.brief import brief
from fe_contact.types import FloatArray

ITERATION_LIMIT = 80
"""Most steps to a root: bisection alone resolves the fraction of a width in 52."""
ROOT_ERROR = 4e-16
"""Step relative to the root at which the search ends: two roundings of a number."""
SMALLEST_ROOT = 1e-9
"""Root to which steps are relative where it is smaller."""


@dataclass(frozen=True)
class ForceCubic:
    """One cubic per query, between two levels: deflection, force and stiffness at its ends, each (Q, 2)."""

    deflection_ends: FloatArray
    deflection_slopes: FloatArray
    force_ends: FloatArray
    stiffness_ends: FloatArray
    stiffness_slopes: FloatArray

    @cached_property
    def width(self) -> FloatArray:
        """Deflection from the lower to the upper end."""
        return np.asarray(self.deflection_ends[:, 1] - self.deflection_ends[:, 0])

    @cached_property
    def tangent_ends(self) -> FloatArray:
        """Derivatives of the force in the fraction of the width at both ends, (2, Q)."""
        return np.asarray(self.width * self.stiffness_ends.T)

    def cubic(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the force and its derivative by t, at the fraction t of the width."""
        (low, high), (k0, k1) = self.force_ends.T, self.tangent_ends
        s = 1.0 - t
        force = low + (high - low) * t * t * (3.0 - 2.0 * t) + t * s * (s * k0 - t * k1)
        return force, 6.0 * t * s * (high - low) + s * (1.0 - 3.0 * t) * k0 + t * (3.0 * t - 2.0) * k1

    def position_slope(self, t: FloatArray, tangent: FloatArray) -> FloatArray:
        """Return the derivative of the force by position at constant deflection; `tangent` is that by t."""
        s = 1.0 - t
        width, width_slope = self.width, self.deflection_slopes[:, 1] - self.deflection_slopes[:, 0]
        end_tangents = width_slope[:, None] * self.stiffness_ends + width[:, None] * self.stiffness_slopes
        slope = -(self.deflection_slopes[:, 0] + t * width_slope) / width
        return np.asarray(tangent * slope + t * s * (s * end_tangents[:, 0] - t * end_tangents[:, 1]))

    def sample(
        self, d: FloatArray, lifted: NDArray[np.bool_], above: NDArray[np.bool_]
    ) -> tuple[FloatArray, ...]:
        """Return force, stiffness and derivative of the force by position at the deflection d.

        They are zero for queries that are `lifted` off, and those of the straight line for queries `above`.
        """
        beyond = d - self.deflection_ends[:, 1]
        t = np.clip((d - self.deflection_ends[:, 0]) / self.width, 0.0, 1.0)
        force, tangent = self.cubic(t)
        end, end_slope = self.stiffness_ends[:, 1], self.stiffness_slopes[:, 1]
        straight_slope = end_slope * beyond - end * self.deflection_slopes[:, 1]
        force = np.where(above, self.force_ends[:, 1] + end * beyond, np.maximum(force, 0.0))
        stiffness = np.where(above, end, np.maximum(tangent / self.width, 0.0))
        position_slope = np.where(above, straight_slope, self.position_slope(t, tangent))
        return tuple(np.where(lifted, 0.0, values) for values in (force, stiffness, position_slope))

    def deflection(self, force: FloatArray, above: NDArray[np.bool_]) -> FloatArray:
        """Return the deflection at which the cubic, or for queries `above` the line, reaches `force`."""
        beyond = (force - self.force_ends[:, 1]) / self.stiffness_ends[:, 1]
        inside = self.deflection_ends[:, 0] + self._fraction(force) * self.width
        return np.where(above, self.deflection_ends[:, 1] + beyond, inside)

    def _fraction(self, force: FloatArray) -> FloatArray:
        """Return the root t in [0, 1] of the monotone cubic by Newton's method.

        A step that would leave the bracket [low, high] of the root halves the bracket instead.
        """
        low, high = np.zeros_like(force), np.ones_like(force)
        t = np.clip(
            (force - self.force_ends[:, 0]) / (self.force_ends[:, 1] - self.force_ends[:, 0]), 0.0, 1.0
        )
        for _ in range(ITERATION_LIMIT):
            value, tangent = self.cubic(t)
            short = value < force
            low, high = np.where(short, t, low), np.where(short, high, t)
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = t - (value - force) / tangent
            following = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
            following = np.where(value == force, t, following)
            step, t = np.abs(following - t), following
            if np.all(step <= ROOT_ERROR * np.maximum(t, SMALLEST_ROOT)):
                break
        return t


@brief
@dataclass(frozen=True, eq=False)
class ForceTable:
    """Levels of constant mesh force over position; read-only arrays."""

    position: FloatArray
    """Knots in transverse base pitches, increasing in [0, period). Shape (P,)."""
    level: FloatArray
    """Transverse mesh force F_bt in N at the levels, increasing, level[0] = 0 (lift-off). Shape (L,)."""
    misalignment: FloatArray
    """Misalignment, m; length 1 = no such axis. Shape (M,)."""
    center_distance_change: FloatArray
    """Change of the center distance, m; length 1 = no such axis. Shape (D,)."""
    deflection: FloatArray
    """Transmission error at level k in m, increasing in k. Shape (M, D, P, L)."""
    deflection_slope: FloatArray
    """Derivative of the deflection in position, m per base pitch. Shape (M, D, P, L)."""
    stiffness: FloatArray
    """Mesh stiffness dF_bt / d(deflection), N/m, limited so that the force is monotone; 0 at lift-off. Shape
    (M, D, P, L).
    """
    stiffness_slope: FloatArray
    """Derivative of the stiffness in position, N/m per base pitch. Shape (M, D, P, L)."""
    period: int = 1
    """Whole base pitches after which the table repeats."""
    deflection_derivative: FloatArray | None = None
    stiffness_derivative: FloatArray | None = None
    """`deflection_derivative`, `stiffness_derivative`: Derivatives of deflection and stiffness of order 1 or
    0 in misalignment, center-distance change and position, for the C1 interpolant over all axes. None without
    a second knot of misalignment or center distance. Shape (2, 2, 2, M, D, P, L) each.
    """
    load_arm: FloatArray | None = None
    """Arm of the load about the axis of a misalignment at each level, m: from mid-face of the driving gear
    towards its positive z, less tan(beta_b) times the way along the line of action from the pitch point. At
    lift-off it is that of the lowest load. Shape (M, D, P, L).
    """
    sliding_share: FloatArray | None = None
    sliding_lever: FloatArray | None = None
    """`sliding_share`, `sliding_lever`: Sums over the pairs of load share times the sign of y, and times |y|
    (m): y is the place of a pair's contact from the pitch point, > 0 where it recedes. Shape (M, D, P, L)
    each.
    """

    def __post_init__(self) -> None:
        for entry in fields(self):
            if entry.name == "period" or getattr(self, entry.name) is None:
                continue
            array = np.array(getattr(self, entry.name), dtype=float, order="C")
            array.flags.writeable = False
            object.__setattr__(self, entry.name, array)

    def at_misalignment(self, index: int, misalignment: FloatArray) -> ForceTable:
        """Return the table at one node of the misalignment, whose axis then has this node alone.

        The node gets the value `misalignment` (1,), m.
        """
        node = slice(index, index + 1)
        load_arm, sliding_share, sliding_lever = (None if arm is None else arm[node] for arm in self.arms)
        return ForceTable(
            position=self.position,
            level=self.level,
            misalignment=misalignment,
            center_distance_change=self.center_distance_change,
            deflection=self.deflection[node],
            deflection_slope=self.deflection_slope[node],
            stiffness=self.stiffness[node],
            stiffness_slope=self.stiffness_slope[node],
            period=self.period,
            load_arm=load_arm,
            sliding_share=sliding_share,
            sliding_lever=sliding_lever,
        )

    @property
    def arms(self) -> tuple[FloatArray | None, FloatArray | None, FloatArray | None]:
        """Points of application: arm about the axis of a misalignment, share and lever of sliding."""
        return self.load_arm, self.sliding_share, self.sliding_lever
