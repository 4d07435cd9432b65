"""Elasticity and mass of a ring as Fourier series over its angle, in the plane of the ring.

The ring is a curved beam after Winkler and Timoshenko: a section stays plane, turns against its center line,
and has the strain of its own radius. With the radial displacement w (outwards), the tangential one v and the
rotation psi of a section, all at the center line of radius R, at a distance y from it::

    radial  w               circumferential strain  (w + v' + y psi') / (R + y)
    tangential  v + y psi   shear strain            (w' - v + R psi) / (R + y)

where ' is the derivative over the angle. A harmonic n is ``w = W e^(i n a)``, ``v = -i V e^(i n a)`` and
``R psi = -i P e^(i n a)``; the amplitudes (W, V, P), all lengths, then have real matrices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dynamics.errors import InputError
from dynamics.types import FloatArray


@dataclass(frozen=True)
class Annulus:
    """A ring of rectangular section, isotropic. Raises `InputError`: a size that leaves no ring."""

    inner_radius: float
    """Radius of the inner surface, m."""
    outer_radius: float
    """Radius of the outer surface, m."""
    width: float
    """Width along the axis, m."""
    youngs_modulus: float = 210e9
    """Young's modulus, Pa."""
    poissons_ratio: float = 0.3
    """Poisson's ratio."""
    density: float = 7850.0
    """Density, kg/m^3."""
    tooth_depth: float = 0.0
    """Depth of teeth inside the inner surface, m: half of this layer is mass, which carries nothing."""

    def __post_init__(self) -> None:
        for name in ("inner_radius", "width", "youngs_modulus", "density"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError(name, value, "> 0", "State it in SI units.")
        if not self.outer_radius > self.inner_radius:
            raise InputError(
                "outer_radius",
                self.outer_radius,
                f"> {self.inner_radius:g} m, the inner radius",
                "The outer surface lies beyond the roots of the teeth.",
            )

    @property
    def height(self) -> float:
        """Radial height of the section, m."""
        return self.outer_radius - self.inner_radius

    @property
    def mean_radius(self) -> float:
        """Radius of the center line, m."""
        return 0.5 * (self.inner_radius + self.outer_radius)

    @cached_property
    def _section(self) -> tuple[float, float, float]:
        """Integrals of 1, y and y^2 over r on the section, m, m^2 and m^3."""
        mean, height = self.mean_radius, self.height
        slope = math.log(self.outer_radius / self.inner_radius)
        lost = height - mean * slope  # small against both: of third order in the height
        return self.width * slope, self.width * lost, -self.width * mean * lost

    @property
    def shear_rigidity(self) -> float:
        """Shear modulus times the integral of 1 / r, with the shear coefficient of Cowper (1966), N/m."""
        ratio = self.poissons_ratio
        coefficient = 10.0 * (1.0 + ratio) / (12.0 + 11.0 * ratio)
        return coefficient * 0.5 * self.youngs_modulus / (1.0 + ratio) * self._section[0]

    def stiffness(self, harmonic: int) -> FloatArray:
        """Return the stiffness of a harmonic per radian, (3, 3), N/m."""
        extension = np.array([1.0, harmonic, 0.0])
        bending = np.array([0.0, 0.0, harmonic / self.mean_radius])
        shear = np.array([harmonic, 1.0, -1.0])
        first, second, third = self._section
        both = np.outer(extension, bending)
        elastic = first * np.outer(extension, extension) + second * (both + both.T)
        elastic += third * np.outer(bending, bending)
        return self.youngs_modulus * elastic + self.shear_rigidity * np.outer(shear, shear)

    @cached_property
    def mass(self) -> FloatArray:
        """The mass of any harmonic per radian, (3, 3), kg."""
        half, mean = 0.5 * self.height, self.mean_radius
        first, second, third = np.zeros(3)
        for inner, outer, filled in ((-half, half, 1.0), (-half - self.tooth_depth, -half, 0.5)):
            power = [(outer**k - inner**k) / k for k in (1, 2, 3, 4)]
            first += filled * (mean * power[0] + power[1])
            second += filled * (mean * power[1] + power[2]) / mean
            third += filled * (mean * power[2] + power[3]) / mean**2
        return (
            self.density
            * self.width
            * np.array([[first, 0.0, 0.0], [0.0, first, second], [0.0, second, third]])
        )

    def motion(self, radius: float, radial: float, tangential: float) -> np.ndarray:
        """Return the displacement at a radius in a direction, of the amplitudes of a harmonic, (3,), complex.

        Parameters
        ----------
        radius : float
            Radius of the point, m, which may lie on a tooth.
        radial, tangential : float
            Components of the direction: outwards, and along increasing angles.
        """
        arm = (radius - self.mean_radius) / self.mean_radius
        return np.array([radial, -1j * tangential, -1j * tangential * arm])
