"""The solid of a housing: material, walls of seats, files, settings of its reduction; no mesh.

The last value of a `Declared` is an example for the documentation, not the default.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum, auto

from bounds import Declared, Kind, between, declared, described, integers, one_of, required, up_to
from dynamics.checks import declared_fields

STEP_SUFFIXES = (".step", ".stp")
MESH_FORMATS = {
    ".msh": "gmsh",
    ".inp": "Abaqus",
    ".bdf": "Nastran",
    ".nas": "Nastran",
    ".fem": "Nastran",
    ".vtu": "VTU",
    ".vtk": "VTK",
}
"""Formats of mesh files by suffix. CalculiX reads and writes the format of Abaqus."""
MESH_SUFFIXES = tuple(MESH_FORMATS)

_YOUNG = Declared(Kind.STIFFNESS, "Pa", between(1e6, 2e12), "Young's modulus", 110e9)
_POISSON = Declared(Kind.RATIO, "", between(0.0, 0.49), "Poisson's ratio", 0.26)
_DENSITY = Declared(Kind.INERTIA, "kg/m^3", up_to(1e5), "Density", 7200.0)
_EXPANSION = Declared(
    Kind.RATIO,
    "1/K",
    between(0.0, 1e-3),
    "Coefficient of thermal expansion; needed where the housing has a temperature",
    21e-6,
    omit_default=True,
)
MODES = Declared(
    Kind.COUNT,
    "",
    integers(1, 2000),
    "Modes to keep; responses hold to 0.7 of the highest frequency",
    80,
    omit_default=True,
)
ELEMENT_SIZE = Declared(
    Kind.LENGTH,
    "m",
    up_to(20.0),
    "Edge of an element of a STEP file's mesh; default: the mean wall thickness divided by 0.7",
    0.014,
    omit_default=True,
)
LOSS_FACTOR = Declared(
    Kind.RATIO,
    "",
    between(0.0, 1.0),
    "Loss factor of the material and its joints",
    0.01,
    omit_default=True,
)
BORE_DIAMETER = Declared(Kind.LENGTH, "m", up_to(20.0), "Diameter of the bore", 0.062)
BORE_LENGTH = Declared(Kind.LENGTH, "m", up_to(20.0), "Length of the bore along its axis", 0.025)


@described
@dataclass(frozen=True)
class Material:
    """Isotropic elasticity, density and thermal expansion."""

    youngs_modulus: float = required(_YOUNG)
    poissons_ratio: float = required(_POISSON)
    density: float = required(_DENSITY)
    thermal_expansion: float | None = declared(None, _EXPANSION)

    def __post_init__(self) -> None:
        declared_fields(self)

    @property
    def lame(self) -> tuple[float, float]:
        """Lame's constants lambda and mu, Pa."""
        young, poisson = self.youngs_modulus, self.poissons_ratio
        shear = young / (2.0 * (1.0 + poisson))
        return 2.0 * shear * poisson / (1.0 - 2.0 * poisson), shear


GRAY_CAST_IRON = Material(110e9, 0.26, 7200.0, 11.7e-6)
"""EN-GJL-250 (EN 1561, annex A: 103 to 118 GPa, 0.26, 7200 kg/m^3, 20 to 200 degrees Celsius)."""
SPHEROIDAL_CAST_IRON = Material(169e9, 0.275, 7100.0, 12.5e-6)
"""EN-GJS-400 (EN 1563, annex)."""
CAST_ALUMINUM = Material(73e9, 0.33, 2700.0, 21e-6)
"""Die-cast aluminum-silicon alloys, usual values."""
MATERIALS = {
    "gray_cast_iron": GRAY_CAST_IRON,
    "spheroidal_cast_iron": SPHEROIDAL_CAST_IRON,
    "cast_aluminum": CAST_ALUMINUM,
}


@described
@dataclass(frozen=True)
class ReductionSettings:
    """Settings of mesh, modes and damping.

    With a loss factor a mode is damped by the share of the housing in its strain energy; without one all
    modes have the damping ratio of the housing.
    """

    modes: int = declared(80, MODES)
    element_size: float | None = declared(None, ELEMENT_SIZE)
    loss_factor: float | None = declared(None, LOSS_FACTOR)

    def __post_init__(self) -> None:
        declared_fields(self)


class Ring(StrEnum):
    """Behavior of the wall of a seat.

    ``WEIGHTED_AVERAGE``: it stays elastic; its motion is the rigid motion nearest to that of the wall in
    the mean square over its area, and a force is spread by the same weights (RBE3). ``RIGID``: it moves as a
    rigid ring (RBE2), which stiffens the housing.
    """

    WEIGHTED_AVERAGE = auto()
    RIGID = auto()


_RING = Declared(
    Kind.CHOICE,
    "",
    one_of([ring.value for ring in Ring]),
    "Wall of the bore: weighted_average: elastic, moved by its mean (RBE3); rigid: a rigid ring (RBE2)",
    Ring.WEIGHTED_AVERAGE.value,
)


@described
@dataclass(frozen=True)
class SeatWall:
    """The wall of a bearing seat; its position follows from its bearing."""

    bore_diameter: float = required(BORE_DIAMETER)
    bore_length: float = required(BORE_LENGTH)
    ring: str = declared(Ring.WEIGHTED_AVERAGE.value, _RING)

    def __post_init__(self) -> None:
        declared_fields(self)
