"""The cubic of the force between two levels: value, derivatives, and the deflection for a given force."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fe_contact.types import FloatArray


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
        """Force and its derivative in t at fraction t of the width."""
        (low, high), (k0, k1) = self.force_ends.T, self.tangent_ends
        s = 1.0 - t
        force = low + (high - low) * t * t * (3.0 - 2.0 * t) + t * s * (s * k0 - t * k1)
        return force, 6.0 * t * s * (high - low) + s * (1.0 - 3.0 * t) * k0 + t * (3.0 * t - 2.0) * k1

    def position_slope(self, t: FloatArray, tangent: FloatArray) -> FloatArray:
        """Differentiate in position at constant deflection; `tangent` is the derivative in t."""
        s = 1.0 - t
        width, width_slope = self.width, self.deflection_slopes[:, 1] - self.deflection_slopes[:, 0]
        end_tangents = width_slope[:, None] * self.stiffness_ends + width[:, None] * self.stiffness_slopes
        moved = -(self.deflection_slopes[:, 0] + t * width_slope) / width
        return np.asarray(tangent * moved + t * s * (s * end_tangents[:, 0] - t * end_tangents[:, 1]))

    def sample(
        self, d: FloatArray, lifted: NDArray[np.bool_], above: NDArray[np.bool_]
    ) -> tuple[FloatArray, ...]:
        """Force, stiffness and position slope at deflection d; zero if lifted off, straight above."""
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
        """Deflection at which the cubic, or above it the straight line, reaches `force`."""
        beyond = (force - self.force_ends[:, 1]) / self.stiffness_ends[:, 1]
        inside = self.deflection_ends[:, 0] + self._fraction(force) * self.width
        return np.where(above, self.deflection_ends[:, 1] + beyond, inside)

    def _fraction(self, force: FloatArray) -> FloatArray:
        """Root t in [0, 1] of the monotone cubic: Newton's method, bisecting where it leaves its bracket."""
        low, high = np.zeros_like(force), np.ones_like(force)
        t = np.clip(
            (force - self.force_ends[:, 0]) / (self.force_ends[:, 1] - self.force_ends[:, 0]), 0.0, 1.0
        )
        for _ in range(80):
            value, tangent = self.cubic(t)
            short = value < force
            low, high = np.where(short, t, low), np.where(short, high, t)
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = t - (value - force) / tangent
            following = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
            following = np.where(value == force, t, following)
            step, t = np.abs(following - t), following
            if np.all(step <= 4e-16 * np.maximum(t, 1e-9)):
                break
        return t
