"""A linear bearing: springs and dampers between a point of a shaft's axis and the ground."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.checks import finite, not_negative

DEFAULT_DAMPING_RATIO = 0.05


@dataclass(frozen=True)
class Bushing:
    """A bushing between a shaft and the ground, isotropic across the axis.

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
    """

    name: str
    shaft: str
    position: float
    radial_stiffness: float
    axial_stiffness: float = 0.0
    radial_damping: float | None = None
    axial_damping: float | None = None
    damping_ratio: float = DEFAULT_DAMPING_RATIO

    def __post_init__(self) -> None:
        finite("position", self.position)
        for name in ("radial_stiffness", "axial_stiffness", "damping_ratio"):
            not_negative(name, getattr(self, name))
        for name in ("radial_damping", "axial_damping"):
            if getattr(self, name) is not None:
                not_negative(name, getattr(self, name))
