"""Mass and moments of inertia of turned parts, and rigid bodies on a shaft: gears and discs."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from bounds import Declared, Kind, SiNote, below, between, declarations, declared, described
from dynamics.checks import declared_fields, finite, integer, not_negative, positive, within
from dynamics.errors import InputError

# The steel of shafts whose material is not stated: that of the gears' tables.


STEEL_YOUNGS_MODULUS = 210e9
"""Pa."""
STEEL_POISSON_RATIO = 0.3
STEEL_DENSITY = 7850.0
"""kg/m^3."""
STEEL_EXPANSION = 11.5e-6
"""1/K, from 20 to 100 degrees Celsius."""

TEMPERATURE = Declared(
    Kind.TEMPERATURE,
    "degC",
    between(-273.15, 1000.0),
    "Steady temperature; given where [temperatures] is",
    80.0,
    later=True,
)
EXPANSION = Declared(
    Kind.RATIO, "1/K", between(0.0, 1e-3), "Coefficient of thermal expansion", STEEL_EXPANSION, later=True
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
_MID_FACE = Declared(
    Kind.LENGTH, "m", between(-1000.0, 1000.0), "Mid-face along the shaft, from its left end", 0.1
)
_CENTER = Declared(
    Kind.LENGTH, "m", between(-1000.0, 1000.0), "Center of mass along the shaft, from its left end", 0.1
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
    outer, bore = (
        positive("outer_diameter", outer_diameter) / 2.0,
        not_negative("bore_diameter", bore_diameter) / 2.0,
    )
    if bore >= outer:
        bound = below(outer_diameter, "m", "the outer diameter")
        raise InputError("bore_diameter", bore_diameter, bound)
    mass = positive("density", density) * math.pi * (outer**2 - bore**2) * positive("length", length)
    square = outer**2 + bore**2
    return Inertia(mass, mass * square / 2.0, mass * (3.0 * square + length**2) / 12.0)


# Gears by teeth, base radius and helix, and discs that mesh with nothing.


@described
@dataclass(frozen=True)
class GearBody:
    """An involute gear, rigid, concentric with its `shaft`, its `name` unique among the gears.

    Meshing gears have the same transverse base pitch ``2 pi base_radius / teeth``; `base_radius` and
    `face_width` in m. `base_helix_angle` in rad is > 0 for right hand, < 0 for left hand, 0 for spur.
    `inertia` is that of the gear alone, about its own center at mid-face. The teeth of a ring gear
    (`internal`) point inwards; all numbers stay positive. `base_tooth_thickness` is the transverse thickness
    of a tooth at the base circle, an arc in m, to which the flanks of a ring gear are extended; None: not
    known, assumed half the pitch on the operating pitch circle where a phase depends on it.
    """

    name: str
    shaft: str
    position: float = field(metadata={Declared: _MID_FACE})
    teeth: int
    base_radius: float
    face_width: float
    base_helix_angle: float = 0.0
    inertia: Inertia = field(default_factory=Inertia)
    internal: bool = False
    base_tooth_thickness: float | None = None
    temperature: float | None = declared(None, TEMPERATURE)
    thermal_expansion: float = declared(STEEL_EXPANSION, EXPANSION)

    def __post_init__(self) -> None:
        declared_fields(self)
        integer("teeth", self.teeth, 1, 100_000)
        positive("base_radius", self.base_radius)
        positive("face_width", self.face_width)
        if self.base_tooth_thickness is not None:
            finite("base_tooth_thickness", self.base_tooth_thickness)
        within("base_helix_angle", self.base_helix_angle, -1.2, 1.2, SiNote("Angles are in radians."))

    @property
    def base_pitch(self) -> float:
        """Transverse base pitch, m."""
        return 2.0 * math.pi * self.base_radius / self.teeth


@described
@dataclass(frozen=True)
class DiscBody:
    """A rigid body of revolution fixed on a `shaft`, its `name` unique among the discs.

    `inertia` is about its own center of mass, which lies on the axis at `position`, m from the shaft's left
    end.
    """

    name: str
    shaft: str
    position: float = field(metadata={Declared: _CENTER})
    inertia: Inertia = field(default_factory=Inertia)

    def __post_init__(self) -> None:
        declared_fields(self)
