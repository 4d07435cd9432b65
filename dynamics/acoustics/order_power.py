"""Sound power of orders over a run: levels, A-weighted levels, sums and third octaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.acoustics.hull import ComplexArray
from dynamics.acoustics.levels import a_weighting, sound_power_level
from dynamics.acoustics.modal_resistance import ModalResistance
from dynamics.errors import InputError
from dynamics.orders.third_octaves import band_number, nominal_center
from dynamics.types import FloatArray


@dataclass(frozen=True)
class OrderPower:
    """Sound power of K orders at B operating points, e.g. the speeds of a run-up, each as in a steady state.

    Orders of different frequency add up in power.

    Attributes
    ----------
    frequency : (K, B) array
        Hz, above zero.
    power : (K, B) array
        W.

    Raises
    ------
    InputError
        Shapes differ, a frequency is not above zero, or a power is negative.
    """

    frequency: FloatArray
    power: FloatArray

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
    def total_level(self) -> FloatArray:
        """Return the level of all orders together, (B,), dB."""
        return sound_power_level(self.power.sum(axis=0))

    @property
    def total_weighted_level(self) -> FloatArray:
        """Return the A-weighted level of all orders together, (B,), dB(A)."""
        return sound_power_level(self.weighted_power.sum(axis=0))

    def third_octaves(self) -> tuple[FloatArray, FloatArray]:
        """Return nominal centers (J,) in Hz and powers (J, B) of the bands that any order passes.

        An order is a tone: the band that holds its frequency takes all of it.
        """
        band = band_number(self.frequency)
        bands = np.arange(band.min(), band.max() + 1)
        power = np.stack([np.sum(np.where(band == number, self.power, 0.0), axis=0) for number in bands])
        return nominal_center(bands), power


def order_power(resistance: ModalResistance, frequency: FloatArray, velocity: ComplexArray) -> OrderPower:
    """Return the sound power of orders that move a hull in the shapes of a modal resistance.

    Parameters
    ----------
    frequency : (K, B) array
        Hz, within those of the resistance.
    velocity : (K, B, M) array
        Complex peak amplitudes of the M shapes.

    Raises
    ------
    InputError
        As `ModalResistance.power` does.
    """
    orders = zip(np.asarray(frequency), np.asarray(velocity), strict=True)
    return OrderPower(frequency, np.stack([resistance.power(at, moving) for at, moving in orders]))
