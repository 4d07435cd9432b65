"""Mass and moments of inertia of turned parts, and rigid bodies on a shaft: gears and discs."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bounds import Declared, Kind, below, between, declarations, declared, described
from dynamics.checks import not_negative, positive
from dynamics.errors import InputError

STEEL_YOUNGS_MODULUS = 210e9
"""Young's modulus of steel, Pa."""
STEEL_POISSON_RATIO = 0.3  # Poisson's ratio of steel
STEEL_DENSITY = 7850.0
"""Density of steel, kg/m^3."""
STEEL_EXPANSION = 11.5e-6
"""Thermal expansion of steel from 20 to 100 degrees Celsius, 1/K."""

TEMPERATURE = Declared(
    Kind.TEMPERATURE,
    "degC",
    between(-273.15, 1000.0),
    "Steady temperature; given where [temperatures] is",
    80.0,
    omit_default=True,
)
EXPANSION = Declared(
    Kind.RATIO,
    "1/K",
    between(0.0, 1e-3),
    "Coefficient of thermal expansion",
    STEEL_EXPANSION,
    omit_default=True,
)
_MASS = Declared(Kind.INERTIA, "kg", between(0.0, 1e9), "Mass", 2.0)
_POLAR = Declared(
    Kind.INERTIA, "kg m^2", between(0.0, 1e12), "Moment of inertia about the axis of rotation", 4e-4
)
_TRANSVERSE = Declared(
    Kind.INERTIA,
    "kg m^2",
    between(0.0, 1e12),
    "Moment of inertia across the axis, through the center of mass",
    7e-3,
)


@described
@dataclass(frozen=True)
class Inertia:
    """Inertia of a body of revolution about its own center of mass.

    The inertia of several bodies together may exceed the bounds of one.
    """

    mass: float = declared(0.0, _MASS)
    polar: float = declared(0.0, _POLAR)
    transverse: float = declared(0.0, _TRANSVERSE)

    def __post_init__(self) -> None:
        for name in declarations(Inertia):
            not_negative(name, getattr(self, name))


def hollow_cylinder(
    outer_diameter: float, length: float, bore_diameter: float = 0.0, density: float = STEEL_DENSITY
) -> Inertia:
    """Return the inertia of a hollow (or, with bore 0, solid) cylinder.

    Raises `InputError`: a size is not positive, or the bore is not smaller than the outer diameter.

    Parameters
    ----------
    outer_diameter, length, bore_diameter : float
        m. For a gear use reference diameter and face width.
    density : float
        kg/m^3.
    """
    outer = positive("outer_diameter", outer_diameter) / 2.0
    bore = not_negative("bore_diameter", bore_diameter) / 2.0
    if bore >= outer:
        bound = below(outer_diameter, "m", "the outer diameter")
        raise InputError("bore_diameter", bore_diameter, bound)
    mass = positive("density", density) * math.pi * (outer**2 - bore**2) * positive("length", length)
    square = outer**2 + bore**2
    return Inertia(mass, mass * square / 2.0, mass * (3.0 * square + length**2) / 12.0)
