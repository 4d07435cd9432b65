"""The bearing of a planet on its pin, which turns with the carrier."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.checks import finite
from dynamics.joints.matrix import Matrix
from dynamics.joints.seat import DEFAULT_DAMPING_RATIO, Seat


@dataclass(frozen=True)
class PlanetBearing(Seat):
    """A linear bearing between a point of a planet's axis and the pin in the carrier.

    The pin moves with the carrier as a rigid body: u_pin = u_carrier + r_carrier x lever. The bearing pushes
    it with K d + C d' - preload, d = (x, y, z, tilt_x, tilt_y) the motion of the planet's section less that
    of the pin and its error. Matrices and preload count x away from the carrier's axis and y along
    z x (away), so that they are the same for all planets of a set.

    Attributes
    ----------
    name : str
        Unique among the planet bearings and bushings.
    shaft : str
        The planet's, its displacements described in the frame of `carrier`.
    carrier : str
        The carrier's shaft.
    position : float
        Along the planet's shaft, m from its left end.
    radial_stiffness, axial_stiffness : float
        N/m, >= 0; `radial_stiffness` across the axis in all directions.
    radial_damping, axial_damping : float or None
        N s/m. None: ``2 damping_ratio sqrt(stiffness * mass)`` with the planet's mass divided by
        the number of its bearings.
    damping_ratio : float
        Used where a damping is None.
    radial_error, tangential_error : float
        m; how far the pin is off its nominal position: away from the carrier's axis, and along z x (away).
    stiffness, damping, preload
        As of a `Bushing`, in N, m, rad: tilt stiffness, cross terms; a pin that yields more in one direction.
    """

    name: str
    shaft: str
    carrier: str
    position: float
    radial_stiffness: float = 0.0
    axial_stiffness: float = 0.0
    radial_damping: float | None = None
    axial_damping: float | None = None
    damping_ratio: float = DEFAULT_DAMPING_RATIO
    radial_error: float = 0.0
    tangential_error: float = 0.0
    stiffness: Matrix | None = None
    damping: Matrix | None = None
    preload: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        for name in ("position", "radial_error", "tangential_error"):
            finite(name, getattr(self, name))
        self.check_seat()
