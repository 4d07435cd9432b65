"""Sound power of orders over a run: levels, A-weighted levels, sums and third octaves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from bounds import from_to
from dynamics.acoustics.air import Air
from dynamics.acoustics.hull import Hull
from dynamics.acoustics.levels import a_weighting, sound_power_level
from dynamics.acoustics.radiation import RadiationModel, resistance
from dynamics.checks import increasing
from dynamics.errors import InputError
from dynamics.linearize.line_floor import FloorPower
from dynamics.orders.third_octaves import band_number, nominal_center
from dynamics.results.array_file import stored
from dynamics.types import BoolArray, ComplexArray, FloatArray


@dataclass(frozen=True)
class ModalResistance:
    """Radiation resistance matrices of M shapes over frequency.

    Between two frequencies R/f^2 is linear in f: that of a pulsation is constant at low frequency, and the
    sum of positive semidefinite matrices is one.
    """

    frequency: FloatArray = field(metadata=stored("Hz", "frequency", "frequency"))
    """Frequencies, Hz, increasing. Shape (F,)."""
    matrix: ComplexArray = field(
        metadata=stored("kg s-1", "radiation resistance", "frequency", "coordinate", "coordinate")
    )
    """Resistance matrices, Hermitian, kg/s for shapes of amplitude in m/s. Shape (F, M, M)."""

    def power(self, frequency: FloatArray, velocity: ComplexArray) -> FloatArray:
        """Return the sound power v^H R v / 2 at every sample, (B,), W.

        Raises `InputError`: a frequency lies outside of those computed, or the shapes of arrays differ.

        Parameters
        ----------
        frequency : (B,) array
            Frequencies, Hz.
        velocity : (B, M) array
            Complex peak amplitudes of the shapes, m/s.
        """
        velocity = np.asarray(velocity)
        flow = np.sum(velocity.conj() * self.reaction(frequency, velocity), axis=1)
        return np.asarray(0.5 * flow.real)

    def reaction(self, frequency: FloatArray, velocity: ComplexArray) -> ComplexArray:
        """Return the part R v of the air's force that takes power from the shapes, (B, M), N.

        Re(u^H R v) / 2 is the power that goes by a part u of the velocity; parts of v add up to the whole.
        `frequency`, `velocity`: as of `power`. Raises `InputError` as `power` does.
        """
        frequency, velocity = np.atleast_1d(np.asarray(frequency, dtype=float)), np.asarray(velocity)
        if velocity.shape != (frequency.size, self.matrix.shape[1]):
            raise InputError("velocity", velocity.shape, f"({frequency.size}, {self.matrix.shape[1]})")
        force = np.zeros(velocity.shape, dtype=complex)
        for knot, near, share in self._hats(frequency):
            force[near] += share[:, None] * (velocity[near] @ self.matrix[knot].T)
        return force

    def alone(self, frequency: FloatArray, shapes: FloatArray) -> FloatArray:
        """Return the resistance of each of K vectors of shapes (M, K) by itself, (B, K), at frequencies (B,).

        Raises `InputError`: a frequency lies outside of those computed.
        """
        frequency = np.atleast_1d(np.asarray(frequency, dtype=float))
        diagonal = np.einsum("mk,fmn,nk->fk", shapes.conj(), self.matrix, shapes, optimize=True).real
        resistance = np.zeros((frequency.size, shapes.shape[1]))
        for knot, near, share in self._hats(frequency):
            resistance[near] += share[:, None] * diagonal[knot]
        return resistance

    def _hats(self, frequency: FloatArray) -> Iterator[tuple[int, BoolArray, FloatArray]]:
        """Yield each computed frequency, the samples near it, and what part of its matrix they take."""
        low, high = float(self.frequency[0]), float(self.frequency[-1])
        if not np.all((frequency >= low) & (frequency <= high)):
            outside = frequency[(frequency < low) | (frequency > high)][0]
            raise InputError("frequency", float(outside), from_to(low, high, "Hz", "the computed"))
        interval = np.searchsorted(self.frequency[1:-1], frequency, "right")
        for knot in np.unique(np.concatenate([interval, interval + 1])):
            near = (interval == knot) | (interval + 1 == knot)
            low_of, high_of = self.frequency[interval[near]], self.frequency[interval[near] + 1]
            weight = (frequency[near] - low_of) / (high_of - low_of)
            share = np.where(interval[near] == knot, 1.0 - weight, weight)
            yield int(knot), near, share * (frequency[near] / self.frequency[knot]) ** 2

    def weights(self, frequency: float) -> tuple[tuple[float, float], ...]:
        """Return the computed frequencies, Hz, and by how much each enters the matrix at another one.

        Raises `InputError`: the frequency lies outside of those computed.
        """
        hats = (
            (float(self.frequency[knot]), float(share[0]))
            for knot, _, share in self._hats(np.array([frequency]))
        )
        return tuple((knot, share) for knot, share in hats if share != 0.0)


def modal_resistance(
    model: RadiationModel, hull: Hull, frequency: FloatArray, shapes: ComplexArray, air: Air
) -> ModalResistance:
    """Compute the radiation resistance of shapes (T, M) at at least two increasing frequencies (F,), Hz.

    Raises `InputError`: fewer than two frequencies, or not increasing; or as `radiation.resistance` does.
    """
    knots = np.asarray(frequency, dtype=float)
    if knots.ndim != 1 or knots.size < 2:
        raise InputError("frequency", knots.shape, "at least two frequencies, (F,)")
    increasing("frequency", knots)
    return ModalResistance(
        knots, np.stack([resistance(model, hull, float(knot), shapes, air) for knot in knots])
    )


@dataclass(frozen=True)
class OrderPower:
    """Sound power of K orders at B operating points, e.g. the speeds of a run-up, each as in a steady state.

    Orders of different frequency add up in power. Raises `InputError`: shapes differ, a frequency is not
    above zero, or a power is negative.
    """

    frequency: FloatArray
    """Frequencies of the orders, Hz, above zero. Shape (K, B)."""
    power: FloatArray
    """Sound power of the orders, W. Shape (K, B)."""
    floor: FloorPower | None = None
    """Sound power of orders that are not among these K; totals and bands include it."""

    def __post_init__(self) -> None:
        frequency, power = np.asarray(self.frequency, dtype=float), np.asarray(self.power, dtype=float)
        if frequency.ndim != 2 or power.shape != frequency.shape:
            raise InputError("power", power.shape, f"the shape of the frequencies, {frequency.shape}, (K, B)")
        if not np.all(frequency > 0.0):
            raise InputError("frequency", float(frequency.min()), "above 0 Hz everywhere")
        if not np.all(power >= 0.0):
            raise InputError("power", float(power.min()), "at least 0 W everywhere")

    @property
    def weighted_power(self) -> FloatArray:
        """Return the A-weighted power, (K, B), W."""
        return np.asarray(self.power * 10.0 ** (a_weighting(self.frequency) / 10.0))

    @property
    def level(self) -> FloatArray:
        """Return the sound power level of every order, (K, B), dB re 1e-12 W."""
        return sound_power_level(self.power)

    @property
    def weighted_level(self) -> FloatArray:
        """Return the A-weighted sound power level of every order, (K, B), dB(A) re 1e-12 W."""
        return sound_power_level(self.weighted_power)

    @property
    def weighted_floor(self) -> FloatArray:
        """Return the A-weighted power of orders that are not among these, (B,), W; 0 without any."""
        return self._of_floor("power")

    @property
    def weighted_error(self) -> FloatArray:
        """Return the error of the A-weighted power of all orders by the floor, (B,), W."""
        return self._of_floor("missed")

    def _of_floor(self, name: str, weighted: bool = True) -> FloatArray:
        if self.floor is None:
            return np.zeros(self.power.shape[1])
        weight = 10.0 ** (a_weighting(self.floor.frequency) / 10.0) if weighted else 1.0
        return np.asarray(np.sum(weight * getattr(self.floor, name), axis=1))

    @property
    def total_weighted_power(self) -> FloatArray:
        """Return the A-weighted power of all orders together, (B,), W."""
        return np.asarray(self.weighted_power.sum(axis=0) + self.weighted_floor)

    @property
    def floor_level(self) -> FloatArray | None:
        """Return the A-weighted level of orders that are not among these, (B,), dB(A); None without any."""
        return None if self.floor is None else sound_power_level(self.weighted_floor)

    @property
    def total_error(self) -> FloatArray | None:
        """Return the error of `total_weighted_level` by the floor, (B,), dB; None without a floor."""
        if self.floor is None:
            return None
        total = self.total_weighted_power
        minimum = np.maximum(total - self.weighted_error, self.weighted_power.sum(axis=0))
        return self.total_weighted_level - sound_power_level(minimum)

    @property
    def total_level(self) -> FloatArray:
        """Return the level of all orders together, (B,), dB."""
        return sound_power_level(self.power.sum(axis=0) + self._of_floor("power", weighted=False))

    @property
    def total_weighted_level(self) -> FloatArray:
        """Return the A-weighted level of all orders together, (B,), dB(A)."""
        return sound_power_level(self.total_weighted_power)

    def third_octaves(self) -> tuple[FloatArray, FloatArray]:
        """Return nominal centers (J,) in Hz and powers (J, B) of the bands that any order passes.

        An order is a tone: the band that holds its frequency takes all of it.
        """
        parts = [(band_number(self.frequency), self.power)]
        if self.floor is not None:
            has_power = np.any(self.floor.power > 0.0, axis=0)
            parts.append(
                (band_number(self.floor.frequency[:, has_power].T), self.floor.power[:, has_power].T)
            )
        ends = [end for band, _ in parts if band.size for end in (band.min(), band.max())]
        bands = np.arange(min(ends), max(ends) + 1)
        sums = [
            [np.sum(np.where(band == number, power, 0.0), axis=0) for number in bands]
            for band, power in parts
        ]
        return nominal_center(bands), np.sum(sums, axis=0)


def order_power(resistance: ModalResistance, frequency: FloatArray, velocity: ComplexArray) -> OrderPower:
    """Return the sound power of orders that move a hull in the shapes of a modal resistance.

    Raises `InputError` as `ModalResistance.power` does.

    Parameters
    ----------
    frequency : (K, B) array
        Frequencies within those of the resistance, Hz.
    velocity : (K, B, M) array
        Complex peak amplitudes of the M shapes.
    """
    orders = zip(np.asarray(frequency), np.asarray(velocity), strict=True)
    return OrderPower(frequency, np.stack([resistance.power(at, moving) for at, moving in orders]))
