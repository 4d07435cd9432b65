"""A piece of a shaft: a cylinder or a cone, solid or hollow, and its cross sections along the axis."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bounds import Declared, Kind, below, between, declared, described, required, up_to
from dynamics.checks import declared_fields
from dynamics.errors import InputError
from dynamics.shafts.bodies import (
    STEEL_DENSITY,
    STEEL_POISSON_RATIO,
    STEEL_YOUNGS_MODULUS,
    Inertia,
    hollow_cylinder,
)
from dynamics.types import FloatArray

_ROUNDING = 1e-9
"""Number of parts beyond a whole number that is rounding of the logarithm."""
_EXACT = np.polynomial.legendre.leggauss(4)
"""Points and weights that integrate polynomials up to degree 7: inertia has degree 6 along a cone."""

_LENGTH = Declared(Kind.LENGTH, "m", up_to(1000.0), "Length", 0.08)
_OUTER = Declared(Kind.LENGTH, "m", up_to(100.0), "Outer diameter, of a cone at its left end", 0.04)
_BORE = Declared(Kind.LENGTH, "m", between(0.0, 100.0), "Bore, of a cone at its left end; 0: solid", 0.01)
_END_OUTER = Declared(
    Kind.LENGTH, "m", up_to(100.0), "Outer diameter at the right end; left out: as at the left end", 0.06
)
_END_BORE = Declared(
    Kind.LENGTH, "m", between(0.0, 100.0), "Bore at the right end; left out: as at the left end", 0.02
)
_YOUNG = Declared(Kind.STIFFNESS, "Pa", up_to(1e18), "Young's modulus", 210e9)
_POISSON = Declared(Kind.RATIO, "", between(0.0, 0.499), "Poisson's ratio", 0.3)
_DENSITY = Declared(Kind.INERTIA, "kg/m^3", up_to(1e6), "Density", 7850.0)


class _CrossSection(NamedTuple):
    """Cross sections: area in m^2, second moment of area about an axis across in m^4, shear coefficient."""

    area: FloatArray
    second_moment: FloatArray
    shear_coefficient: FloatArray


@described
@dataclass(frozen=True)
class BeamSection:
    """A piece of a shaft, of steel unless its material is given.

    A cylinder, or with another diameter or bore at the right end a cone: both vary linearly along the axis.
    """

    length: float = required(_LENGTH)
    outer_diameter: float = required(_OUTER)
    bore_diameter: float = declared(0.0, _BORE)
    youngs_modulus: float = declared(STEEL_YOUNGS_MODULUS, _YOUNG)
    poissons_ratio: float = declared(STEEL_POISSON_RATIO, _POISSON)
    density: float = declared(STEEL_DENSITY, _DENSITY)
    end_outer_diameter: float | None = declared(None, _END_OUTER)
    end_bore_diameter: float | None = declared(None, _END_BORE)

    def __post_init__(self) -> None:
        declared_fields(self)
        fields = ("bore_diameter", "end_bore_diameter")
        for field, bore, outer in zip(fields, self.bore_diameters, self.outer_diameters, strict=True):
            if bore >= outer:
                raise InputError(field, bore, below(outer, "m", "the outer diameter"))

    @property
    def outer_diameters(self) -> tuple[float, float]:
        """Outer diameters at the left and the right end, m."""
        end = self.end_outer_diameter
        return self.outer_diameter, self.outer_diameter if end is None else end

    @property
    def bore_diameters(self) -> tuple[float, float]:
        """Bore diameters at the left and the right end, m; 0 where the piece is solid."""
        end = self.end_bore_diameter
        return self.bore_diameter, self.bore_diameter if end is None else end

    @property
    def shear_modulus(self) -> float:
        """Shear modulus, Pa."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))

    def cross_section(self, share: float | FloatArray = 0.0) -> _CrossSection:
        """Return the cross sections at shares of the length (0: left end, 1: right end).

        The shear coefficient is the share of the area that carries shear: Cowper, J. Appl. Mech. 33 (1966)
        335-340, hollow circle.
        """
        fraction = np.asarray(share, dtype=float)
        outer, bore = (
            left + fraction * (right - left) for left, right in (self.outer_diameters, self.bore_diameters)
        )
        nu, square = self.poissons_ratio, (bore / outer) ** 2
        quotient = (1.0 + square) ** 2
        shear = 6.0 * (1.0 + nu) * quotient / ((7.0 + 6.0 * nu) * quotient + (20.0 + 12.0 * nu) * square)
        return _CrossSection(
            area=math.pi / 4.0 * (outer**2 - bore**2),
            second_moment=math.pi / 64.0 * (outer**4 - bore**4),
            shear_coefficient=shear,
        )

    @property
    def grading(self) -> tuple[float, ...]:
        """Shares of the length between which outer diameter and wall vary by a factor of at most 2.

        The sections of a cone at these shares have diameters in a geometric sequence; so have its walls.
        """
        (left, right), (left_bore, right_bore) = self.outer_diameters, self.bore_diameters
        shares: list[float] = []
        for ratio in (right / left, (right - right_bore) / (left - left_bore)):
            parts = math.ceil(abs(math.log2(ratio)) - _ROUNDING)
            # the linear course from 1 to `ratio` has the value ratio^(k / parts) at this share
            shares += [(ratio ** (k / parts) - 1.0) / (ratio - 1.0) for k in range(1, parts)]
        return tuple(shares)

    @property
    def area(self) -> float:
        """Area of the cross section at the left end, m^2."""
        return float(self.cross_section().area)

    @property
    def second_moment(self) -> float:
        """Second moment of area about an axis across, at the left end, m^4."""
        return float(self.cross_section().second_moment)

    @property
    def shear_coefficient(self) -> float:
        """Share of the area that carries shear, at the left end."""
        return float(self.cross_section().shear_coefficient)

    @property
    def body(self) -> tuple[Inertia, float]:
        """Inertia of the piece about its center of mass, and distance of the center from the left end, m."""
        if self.end_outer_diameter is None and self.end_bore_diameter is None:
            cylinder = hollow_cylinder(self.outer_diameter, self.length, self.bore_diameter, self.density)
            return cylinder, 0.5 * self.length
        share, weight = 0.5 * (1.0 + _EXACT[0]), 0.5 * self.length * self.density * _EXACT[1]
        cut, z = self.cross_section(share), share * self.length
        mass = float(weight @ cut.area)
        center = float(weight @ (cut.area * z)) / mass
        diametral = float(weight @ cut.second_moment)
        transverse = diametral + float(weight @ (cut.area * (z - center) ** 2))
        return Inertia(mass, 2.0 * diametral, transverse), center
