"""Stiffness of a bearing that is the same in all directions across its axis."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.bearings.matrix import Matrix
from dynamics.checks import not_negative


@dataclass(frozen=True)
class BearingStiffness:
    """Stiffness of a bearing, or of all bearings of a shaft seen as one.

    Attributes
    ----------
    radial, axial : float
        N/m, >= 0.
    tilt : float
        About any axis across, N m/rad, >= 0.
    """

    radial: float
    axial: float = 0.0
    tilt: float = 0.0

    def __post_init__(self) -> None:
        for name in ("radial", "axial", "tilt"):
            not_negative(name, getattr(self, name))

    @property
    def matrix(self) -> Matrix | None:
        """The part beyond radial and axial springs, in x, y, z, tilt_x, tilt_y; None: nothing."""
        if self.tilt == 0.0:
            return None
        return tuple(tuple(self.tilt if i == j >= 3 else 0.0 for j in range(5)) for i in range(5))
