"""Radiation resistance of vibration modes, computed at a few frequencies and interpolated between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import between
from dynamics.acoustics.air import Air
from dynamics.acoustics.hull import ComplexArray, Hull
from dynamics.acoustics.radiation import RadiationModel, resistance
from dynamics.checks import increasing
from dynamics.errors import InputError
from dynamics.types import FloatArray


@dataclass(frozen=True)
class ModalResistance:
    """Radiation resistance matrices of M shapes over frequency.

    Between two frequencies R/f^2 is linear in f: that of a pulsation is constant at low frequency, and the
    sum of positive semidefinite matrices is one.

    Attributes
    ----------
    frequency : (F,) array
        Hz, increasing.
    matrix : (F, M, M) array
        Hermitian, kg/s for shapes of amplitude in m/s.
    """

    frequency: FloatArray
    matrix: ComplexArray

    def power(self, frequency: FloatArray, velocity: ComplexArray) -> FloatArray:
        """Return the sound power v^H R v / 2 at every sample, (B,), W.

        Parameters
        ----------
        frequency : (B,) array
            Hz.
        velocity : (B, M) array
            Complex peak amplitudes of the shapes, m/s.

        Raises
        ------
        InputError
            A frequency lies outside of those computed, or the shapes of arrays differ.
        """
        frequency, velocity = np.atleast_1d(np.asarray(frequency, dtype=float)), np.asarray(velocity)
        if velocity.shape != (frequency.size, self.matrix.shape[1]):
            raise InputError("velocity", velocity.shape, f"({frequency.size}, {self.matrix.shape[1]})")
        low, high = float(self.frequency[0]), float(self.frequency[-1])
        if not np.all((frequency >= low) & (frequency <= high)):
            outside = frequency[(frequency < low) | (frequency > high)][0]
            raise InputError("frequency", float(outside), between(low, high, "Hz", "the computed"))
        return self._interpolated(frequency, velocity)

    def _interpolated(self, frequency: FloatArray, velocity: ComplexArray) -> FloatArray:
        """Sum the quadratic forms of both ends of every interval that holds samples."""
        interval = np.searchsorted(self.frequency[1:-1], frequency, "right")
        power = np.zeros(frequency.size)
        for knot in np.unique(np.concatenate([interval, interval + 1])):
            near = (interval == knot) | (interval + 1 == knot)
            weight = _hat(frequency[near], self.frequency[interval[near]], self.frequency[interval[near] + 1])
            share = np.where(interval[near] == knot, 1.0 - weight, weight)
            squares = _quadratic(self.matrix[knot], velocity[near])
            power[near] += 0.5 * share * (frequency[near] / self.frequency[knot]) ** 2 * squares
        return power

    def interpolation_error(self, velocity: ComplexArray) -> float:
        """Return how far every second matrix is missed by those beside it, dB, for a velocity (M,).

        The largest difference of level; the interpolation's own error is about a quarter of it.

        Raises
        ------
        InputError
            With fewer than three frequencies.
        """
        if self.frequency.size < 3:
            raise InputError("frequency", self.frequency.size, "at least three frequencies")
        coarse = ModalResistance(self.frequency[::2], self.matrix[::2])
        between_them = self.frequency[1:-1:2] if self.frequency.size % 2 else self.frequency[1:-2:2]
        repeated = np.broadcast_to(velocity, (between_them.size, np.size(velocity)))
        ratio = coarse.power(between_them, repeated) / self.power(between_them, repeated)
        return float(np.max(np.abs(10.0 * np.log10(ratio))))


def modal_resistance(
    model: RadiationModel, hull: Hull, frequency: FloatArray, shapes: ComplexArray, air: Air
) -> ModalResistance:
    """Compute the radiation resistance of shapes (T, M) at at least two increasing frequencies (F,), Hz.

    Raises
    ------
    InputError
        Fewer than two frequencies, or not increasing; or as `radiation.resistance` does.
    """
    knots = np.asarray(frequency, dtype=float)
    if knots.ndim != 1 or knots.size < 2:
        raise InputError("frequency", knots.shape, "at least two frequencies, (F,)")
    increasing("frequency", knots)
    return ModalResistance(
        knots, np.stack([resistance(model, hull, float(knot), shapes, air) for knot in knots])
    )


def _hat(frequency: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the part of the way from `low` to `high`."""
    return np.asarray((frequency - low) / (high - low))


def _quadratic(matrix: ComplexArray, velocity: ComplexArray) -> FloatArray:
    """Return v^H R v of every row, (B,)."""
    return np.asarray(np.sum(velocity.conj() * (velocity @ matrix.T), axis=1).real)
