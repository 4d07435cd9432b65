"""Vibration of a housing's points and surface under its bearings, by order and speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.types import BoolArray, FloatArray
from dynamics.vibration.bearing_harmonics import BearingHarmonics
from dynamics.vibration.housing_motion import housing_motion
from dynamics.vibration.motion_quantity import MotionQuantity
from dynamics.vibration.points import point_rows
from dynamics.vibration.seat_forces import ComplexArray, seat_forces
from dynamics.vibration.surface_weight import mean_square, surface_weight


@dataclass(frozen=True)
class HousingVibration:
    """Vibration at S speeds in H harmonics, of k points.

    Attributes
    ----------
    point : tuple of str
    speed : (S,) array
        Of the leading drive, rad/s.
    order : (H,) array
        Multiples of the frequency of the first mesh that turns.
    frequency : (S, H) array
        Hz.
    seat_force : (S, H, s) complex array
        Peak amplitudes on the motions of the seats, N and N m.
    velocity : (k, 3, S, H) complex array
        Peak amplitudes along the axes of the mesh, m/s.
    mean_square_velocity : (S, H) array
        Of the outer hull, normal to it, mean over area and time, m^2/s^2; 0 without a surface.
    highest_valid_frequency : float
        `ReducedHousing.valid_frequency`, Hz.
    """

    point: tuple[str, ...]
    speed: FloatArray
    order: FloatArray
    frequency: FloatArray
    seat_force: ComplexArray
    velocity: ComplexArray
    mean_square_velocity: FloatArray
    highest_valid_frequency: float

    @property
    def valid(self) -> BoolArray:
        """Whether the modes kept carry the harmonic, (S, H)."""
        return np.asarray(self.frequency <= self.highest_valid_frequency)

    @property
    def rms(self) -> FloatArray:
        """Root mean square of each point's velocity, all directions together, (k, S, H), m/s."""
        return np.asarray(np.sqrt(0.5 * np.sum(np.abs(self.velocity) ** 2, axis=1)))

    def of(self, quantity: MotionQuantity) -> ComplexArray:
        """Return peak amplitudes of another quantity of the points, (k, 3, S, H)."""
        return self.velocity * (2j * np.pi * self.frequency) ** (quantity.rate - 1)

    def largest(self, speed: float | None = None, order: float | None = None) -> tuple[int, int]:
        """Return the indices of speed and order at which a point moves fastest; without points, the surface.

        Parameters
        ----------
        speed, order : float, optional
            The nearest one alone, rad/s; what is valid comes first.
        """
        near = np.ones(self.frequency.shape, dtype=bool)
        if speed is not None:
            near &= (np.arange(self.speed.size) == np.argmin(np.abs(self.speed - speed)))[:, None]
        if order is not None:
            near &= np.arange(self.order.size) == np.argmin(np.abs(self.order - order))
        near = near & self.valid if np.any(near & self.valid) else near
        size = self.rms.max(axis=0) if self.point else self.mean_square_velocity
        row, column = np.unravel_index(int(np.argmax(np.where(near, size, -1.0))), size.shape)
        return int(row), int(column)


def housing_vibration(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None = None,
    points: Sequence[str] | None = None,
) -> HousingVibration:
    """Return the vibration of a housing under its bearings by speed and order.

    Parameters
    ----------
    response : BearingHarmonics
        Of a scene with the housing, linear or a run's; the forces on its bearings move it.
    housing : ReducedHousing
        With mass.
    bearings : sequence of str, optional
        Bearings in the order of the seats; by default those with the names of the seats.
    points : sequence of str, optional
        By default all, which may be none.

    Raises
    ------
    InputError
        As `seat_forces`, `point_rows` and `housing_motion`.
    """
    force = seat_forces(response, housing, bearings)
    motion = housing_motion(housing, response.frequency, force)
    rate = 2j * np.pi * response.frequency[..., None] * motion
    rows = point_rows(housing, points)
    weight = 0.0 * housing.mass if housing.surface is None else surface_weight(housing)
    return HousingVibration(
        tuple(point.name for point in housing.points) if points is None else tuple(points),
        response.speed,
        response.order,
        response.frequency,
        force,
        np.einsum("kcr,shr->kcsh", rows, rate),
        mean_square(rate, weight),
        housing.valid_frequency,
    )
