"""Sound power of a motion, and the shares of its parts: forces of bearings, modes of the housing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.acoustics.hull import ComplexArray
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.housing_radiation import HousingRadiation
from dynamics.types import FloatArray


@dataclass(frozen=True)
class Contributions:
    """Power and shares in it, W, as `RadiatedSound` has them."""

    power: FloatArray
    efficiency: FloatArray
    bearing_share: FloatArray
    bearing_alone: FloatArray
    mode_share: FloatArray
    mode_alone: FloatArray
    natural_frequency: FloatArray


def contributions(
    frequency: FloatArray, amplitudes: ComplexArray, housing: ReducedHousing, radiation: HousingRadiation
) -> Contributions:
    """Return the power of the motion in the modes under all bearings, and the shares of both.

    The share of a part u of the velocity v is Re(u^H R v) / 2: shares add up to the power v^H R v / 2.

    Parameters
    ----------
    frequency : (S, H) array
        Hz.
    amplitudes : (S H, b, m) array
        Complex peak amplitudes of `ReducedHousing.modes` by bearing.
    """
    grid, hertz = frequency.shape, frequency.ravel()
    natural, shape = housing.modes
    rates = 2j * np.pi * hertz[:, None, None] * amplitudes
    by_bearing = np.moveaxis(rates @ shape.T, 1, 0)
    velocity = by_bearing.sum(axis=0)
    force = radiation.reaction(hertz, velocity)
    power = np.maximum(_power(velocity, force), 0.0)
    kept = slice(0, housing.frequency.size)
    rate = rates.sum(axis=1)[:, kept]
    mode_share = 0.5 * (rate.conj() * (force @ shape[:, kept])).real
    mode_alone = 0.5 * np.abs(rate) ** 2 * radiation.alone(hertz, shape[:, kept])
    alone = [_power(part, radiation.reaction(hertz, part)) for part in by_bearing]
    return Contributions(
        power.reshape(grid),
        radiation.efficiency(power, velocity).reshape(grid),
        np.stack([_power(part, force) for part in by_bearing]).reshape(-1, *grid),
        np.stack(alone).reshape(-1, *grid),
        mode_share.T.reshape(-1, *grid),
        mode_alone.T.reshape(-1, *grid),
        natural[kept] / (2.0 * np.pi),
    )


def _power(velocity: ComplexArray, force: ComplexArray) -> FloatArray:
    """Return Re(v^H f) / 2 of every row, W."""
    return np.asarray(0.5 * np.sum(velocity.conj() * force, axis=1).real)
