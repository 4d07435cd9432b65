"""A linear bearing: springs and dampers between a point of a shaft's axis and the ground."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.checks import finite
from dynamics.joints.matrix import Matrix
from dynamics.joints.seat import DEFAULT_DAMPING_RATIO, Seat


@dataclass(frozen=True)
class Bushing(Seat):
    """A bushing between a shaft and the ground.

    The shaft's section at the bushing moves by d = (x, y, z, tilt_x, tilt_y); the bushing pushes the ground
    with K d + C d' - preload, forces and moments about its center, in N, m, rad. The radial and axial figures
    are the isotropic part of K and C; a matrix is added to them.

    Attributes
    ----------
    name : str
        Unique among the bushings.
    shaft : str
        The shaft it carries.
    position : float
        Along the shaft, m from the shaft's left end.
    radial_stiffness, axial_stiffness : float
        N/m, >= 0.
    radial_damping, axial_damping : float or None
        N s/m. None: ``2 damping_ratio sqrt(stiffness * mass)`` with the mass of the shaft and its gears
        divided by the number of its bushings, so that the shaft bouncing on equal bushings has this
        damping ratio.
    damping_ratio : float
        Used where a damping is None.
    stiffness, damping : 5 by 5 or 6 by 6 matrices or None
        Added, in (x, y, z, tilt_x, tilt_y): tilt stiffness, cross terms; symmetric, positive semidefinite. Of
        a 6 by 6 matrix the row and column of the rotation about the axis are zero: the shaft turns. Without
        a damping matrix a stiffness matrix is damped in proportion, by `damping_ratio` at the frequency at
        which the bushing's share of the mass bounces on the matrix's largest stiffness; of a matrix that
        holds tilt alone, at which its share of the transverse inertia tilts.
    preload : five floats or None
        Force and moment of the bushing on the shaft where d = 0, N and N m, in the same order.
    """

    name: str
    shaft: str
    position: float
    radial_stiffness: float = 0.0
    axial_stiffness: float = 0.0
    radial_damping: float | None = None
    axial_damping: float | None = None
    damping_ratio: float = DEFAULT_DAMPING_RATIO
    stiffness: Matrix | None = None
    damping: Matrix | None = None
    preload: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        finite("position", self.position)
        self.check_seat()
