"""The bearing of a planet on its pin, which turns with the carrier."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.checks import finite, not_negative
from dynamics.joints.bushing import DEFAULT_DAMPING_RATIO


@dataclass(frozen=True)
class PlanetBearing:
    """A linear bearing between a point of a planet's axis and the pin in the carrier.

    The pin moves with the carrier as a rigid body: u_pin = u_carrier + r_carrier x lever.

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
        m; how far the pin is off its place: away from the carrier's axis, and along z x (away).
    """

    name: str
    shaft: str
    carrier: str
    position: float
    radial_stiffness: float
    axial_stiffness: float = 0.0
    radial_damping: float | None = None
    axial_damping: float | None = None
    damping_ratio: float = DEFAULT_DAMPING_RATIO
    radial_error: float = 0.0
    tangential_error: float = 0.0

    def __post_init__(self) -> None:
        for name in ("position", "radial_error", "tangential_error"):
            finite(name, getattr(self, name))
        for name in ("radial_stiffness", "axial_stiffness", "damping_ratio"):
            not_negative(name, getattr(self, name))
        for name in ("radial_damping", "axial_damping"):
            if getattr(self, name) is not None:
                not_negative(name, getattr(self, name))
