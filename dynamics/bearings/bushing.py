"""A linear bearing: springs and dampers between a point of a shaft's axis and the ground."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import declared, described, required
from dynamics.bearings import seat
from dynamics.bearings.matrix import Matrix


@described
@dataclass(frozen=True)
class Bushing(seat.Seat):
    """A bushing between a shaft and the ground.

    The shaft's section at the bushing moves by d = (x, y, z, tilt_x, tilt_y); the bushing acts on the ground
    with K d + C d' - preload, forces and moments about its center, in N, m, rad. The radial and axial values
    are the isotropic part of K and C; a matrix is added to them.

    A damping that is None is ``2 damping_ratio sqrt(stiffness * mass)`` with the mass of the shaft and its
    gears divided by the number of its bushings, so that the shaft bouncing on equal bushings has this ratio.

    The matrices `stiffness` and `damping`, 5 by 5 or 6 by 6 in (x, y, z, tilt_x, tilt_y), are symmetric and
    positive semidefinite: tilt stiffness, cross terms. In a 6 by 6 matrix the row and column of the rotation
    about the axis are zero: the shaft turns. Without a damping matrix damping is proportional to the
    stiffness matrix, with `damping_ratio` at the natural frequency of the bushing's share of the mass on the
    matrix's largest stiffness, or of its share of the transverse inertia on a matrix with tilt stiffness
    alone. `preload` are five numbers, force and moment of the bushing on the shaft at d = 0, N and N m, in
    the same order.
    """

    name: str
    shaft: str
    position: float = required(seat.POSITION)
    radial_stiffness: float = declared(0.0, seat.RADIAL_STIFFNESS)
    axial_stiffness: float = declared(0.0, seat.AXIAL_STIFFNESS)
    radial_damping: float | None = declared(None, seat.RADIAL_DAMPING)
    axial_damping: float | None = declared(None, seat.AXIAL_DAMPING)
    damping_ratio: float = declared(seat.DEFAULT_DAMPING_RATIO, seat.DAMPING_RATIO)
    stiffness: Matrix | None = None
    damping: Matrix | None = None
    preload: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        self.check_seat()
