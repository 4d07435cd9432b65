"""Vibration of a housing: its quantities, levels and points, and the spectra of its surface.

References
----------
.. [1] ISO 1683:2015, Acoustics - Preferred reference values: 1 pm, 1 nm/s, 1 um/s^2, root mean square.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum, auto

import numpy as np
from numpy.typing import ArrayLike

from dynamics.acoustics import outer_hull
from dynamics.acoustics.levels import FLOOR
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import PointMotion, ReducedHousing
from dynamics.linearize.line_floor import LineFloor
from dynamics.types import BoolArray, ComplexArray, FloatArray
from dynamics.vibration.housing_motion import BearingHarmonics, housing_motion, modal_amplitudes, seat_forces


class MotionQuantity(StrEnum):
    """Quantity of a motion: displacement or one of its derivatives in time."""

    DISPLACEMENT = auto()
    VELOCITY = auto()
    ACCELERATION = auto()

    @property
    def rate(self) -> int:
        """Number of derivatives in time: 0, 1, 2."""
        return list(MotionQuantity).index(self)

    def of(self, displacement: ComplexArray, frequency: FloatArray) -> ComplexArray:
        """Return complex amplitudes of the quantity, by those of the displacement in m or rad.

        Parameters
        ----------
        displacement : array
        frequency : array
            Frequencies, Hz, of a shape that spreads over that of `displacement`.
        """
        return np.asarray((2j * math.pi * np.asarray(frequency)) ** self.rate * displacement)


REFERENCE = {
    MotionQuantity.DISPLACEMENT: 1e-12,
    MotionQuantity.VELOCITY: 1e-9,
    MotionQuantity.ACCELERATION: 1e-6,
}
"""Root mean square values of 0 dB, SI, of [1]_."""


def vibration_level(rms: ArrayLike, quantity: MotionQuantity = MotionQuantity.VELOCITY) -> FloatArray:
    """Return the level of root mean square values, dB re 1 nm/s for velocities, at least `FLOOR`.

    `rms`: m, m/s or m/s^2, any shape; 1/sqrt(2) of a peak amplitude. Raises `InputError`: a value is negative
    or no number.
    """
    values = np.asarray(rms, dtype=float)
    if not np.all(values >= 0.0):
        raise InputError("rms", float(np.min(values)), "at least 0 everywhere")
    return np.asarray(20.0 * np.log10(np.maximum(values / REFERENCE[quantity], 10.0 ** (FLOOR / 20.0))))


def overall(rms: ArrayLike, axis: int = -1) -> FloatArray:
    """Return the root mean square of all harmonics together: the root of the sum of their squares."""
    return np.asarray(np.sqrt(np.sum(np.square(np.asarray(rms, dtype=float)), axis=axis)))


def named_points(housing: ReducedHousing, names: Sequence[str] | None = None) -> tuple[PointMotion, ...]:
    """Return points by their names, by default all.

    Raises `InputError`: the housing has no such point, or none at all.
    """
    if not housing.points:
        raise InputError(
            "points", [], "at least one named point", "Name points where the housing is reduced."
        )
    point_of = {point.name: point for point in housing.points}
    for index, name in enumerate(names or ()):
        if name not in point_of:
            raise InputError(f"points[{index}]", name, f"one of {', '.join(point_of)}")
    return tuple(point_of.values()) if names is None else tuple(point_of[name] for name in names)


def point_rows(housing: ReducedHousing, names: Sequence[str] | None = None) -> FloatArray:
    """Return the motion of named points per reduced coordinate, (k, 3, r); by default of all points.

    A housing without points has k = 0, unless `names` asks for one, which raises `InputError`.
    """
    points = named_points(housing, names) if housing.points or names else ()
    return np.array([point.motion for point in points]).reshape(-1, 3, len(housing.mass))


def surface_weight(housing: ReducedHousing) -> FloatArray:
    """Return the mean over the outer hull of the products of normal motions, (r, r).

    Walls of cavities are left out and openings capped (`outer_hull`): with the hull's area and rho c of the
    air a mean square velocity gives the equivalent radiated power. Raises `InputError`: the housing has no
    surface.
    """
    outer = outer_hull(housing)
    return outer.surface / outer.hull.area


def mean_square(motion: ComplexArray, weight: FloatArray) -> FloatArray:
    """Return the mean square over surface and time, (...), x^H W x / 2 of peak amplitudes (..., r)."""
    return np.asarray(0.5 * np.sum(motion.conj() * (motion @ weight), axis=-1).real)


@dataclass(frozen=True)
class HousingVibration:
    """Vibration at S speeds in H harmonics, of k points."""

    point: tuple[str, ...]
    speed: FloatArray
    """Speed of the leading drive, rad/s. Shape (S,)."""
    order: FloatArray
    """Multiples of the frequency of the first mesh that turns. Shape (H,)."""
    frequency: FloatArray
    """Frequencies of the harmonics, Hz. Shape (S, H)."""
    seat_force: ComplexArray
    """Peak amplitudes on the motions of the seats, N and N m. Shape (S, H, s)."""
    velocity: ComplexArray
    """Peak amplitudes along the axes of the mesh, m/s. Shape (k, 3, S, H)."""
    mean_square_velocity: FloatArray
    """Mean square velocity normal to the outer hull, over area and time, m^2/s^2; 0 without a surface. Shape
    (S, H).
    """
    highest_valid_frequency: float
    """`ReducedHousing.valid_frequency`, Hz."""
    floor: FloatArray | None = None
    floor_error: FloatArray | None = None
    """`floor`, `floor_error`: Mean square velocity of each point in the unlisted orders of long tables, and
    its error, m^2/s^2; None where every order is listed. Shape (k, S) each.
    """

    @property
    def valid(self) -> BoolArray:
        """Whether the harmonic is within the frequencies for which the housing has modes, (S, H)."""
        return np.asarray(self.frequency <= self.highest_valid_frequency)

    @property
    def rms(self) -> FloatArray:
        """Root mean square of each point's velocity, all directions together, (k, S, H), m/s."""
        return np.asarray(np.sqrt(0.5 * np.sum(np.abs(self.velocity) ** 2, axis=1)))

    @property
    def overall(self) -> FloatArray:
        """Root mean square velocity of each point, all directions and orders together, (k, S), m/s."""
        return self._with_floor(0.0)

    @property
    def overall_error(self) -> FloatArray:
        """Error of `overall` by the orders that are not listed, (k, S), m/s."""
        return self.overall - self._with_floor(1.0)

    def _with_floor(self, share: float) -> FloatArray:
        """Return `overall` with the floor lowered by a share of its error; the floor is at least 0."""
        if self.floor is None or self.floor_error is None:
            return overall(self.rms)
        listed = np.sum(np.square(self.rms), axis=-1)
        return np.asarray(np.sqrt(listed + np.maximum(self.floor - share * self.floor_error, 0.0)))

    def of(self, quantity: MotionQuantity) -> ComplexArray:
        """Return peak amplitudes of another quantity of the points, (k, 3, S, H)."""
        return self.velocity * (2j * np.pi * self.frequency) ** (quantity.rate - 1)

    def largest(self, speed: float | None = None, order: float | None = None) -> tuple[int, int]:
        """Return the indices of speed and order at which a point moves fastest; without points, the surface.

        `speed` in rad/s, `order`: search at the nearest speed or order alone. Harmonics that are `valid` are
        preferred to larger ones that are not.
        """
        near = np.ones(self.frequency.shape, dtype=bool)
        if speed is not None:
            near &= (np.arange(self.speed.size) == np.argmin(np.abs(self.speed - speed)))[:, None]
        if order is not None:
            near &= np.arange(self.order.size) == np.argmin(np.abs(self.order - order))
        near = near & self.valid if np.any(near & self.valid) else near
        size = self.rms.max(axis=0) if self.point else self.mean_square_velocity
        # -1 is below every velocity: harmonics that are not searched
        row, column = np.unravel_index(int(np.argmax(np.where(near, size, -1.0))), size.shape)
        return int(row), int(column)


def housing_vibration(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None = None,
    points: Sequence[str] | None = None,
) -> HousingVibration:
    """Return the vibration of a housing under its bearings by speed and order.

    Raises `InputError` as `seat_forces`, `point_rows` and `housing_motion`.

    Parameters
    ----------
    response : BearingHarmonics
        Response of a scene with the housing, linear or of a run; the forces on the bearings move the housing.
    housing : ReducedHousing
        Housing with mass.
    bearings : sequence of str, optional
        Bearings in the order of the seats; by default those with the names of the seats.
    points : sequence of str, optional
        Points by name; by default all, which may be none.
    """
    force = seat_forces(response, housing, bearings)
    motion = housing_motion(housing, response.frequency, force)
    rate = 2j * np.pi * response.frequency[..., None] * motion
    rows = point_rows(housing, points)
    weight = 0.0 * housing.mass if housing.surface is None else surface_weight(housing)
    floor, floor_error = (
        (None, None) if response.floor is None else _point_floor(response.floor, housing, bearings, rows)
    )
    return HousingVibration(
        point=tuple(point.name for point in housing.points) if points is None else tuple(points),
        speed=response.speed,
        order=response.order,
        frequency=response.frequency,
        seat_force=force,
        velocity=np.einsum("kcr,shr->kcsh", rows, rate),
        mean_square_velocity=mean_square(rate, weight),
        highest_valid_frequency=housing.valid_frequency,
        floor=floor,
        floor_error=floor_error,
    )


def _point_floor(
    floor: LineFloor, housing: ReducedHousing, bearings: Sequence[str] | None, rows: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the mean squares (k, S) of velocities in the lines left out, m^2/s^2, and their errors.

    `rows` (k, 3, r): the motion of the points per reduced coordinate.
    """
    amplitude = modal_amplitudes(housing, floor.frequency, seat_forces(floor, housing, bearings))
    rate = 2j * np.pi * floor.frequency[:, None, None] * (amplitude @ housing.modes[1].T)
    velocities = [rate @ velocity.T for velocity in rows]
    powers = [floor.power(0.5 * velocity.conj() @ np.swapaxes(velocity, 1, 2)) for velocity in velocities]
    shape = (len(rows), floor.pace.size)
    return (
        np.reshape([np.sum(power.power, axis=1) for power in powers], shape),
        np.reshape([np.sum(power.missed, axis=1) for power in powers], shape),
    )
