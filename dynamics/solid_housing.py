"""What a housing is by its solid: material, walls of seats, files, settings of its reduction; no mesh."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum, auto
from io import BytesIO, TextIOWrapper
from pathlib import PurePath
from xml.parsers import expat

from bounds import Declared, Kind, between, declared, described, integers, one_of, required, up_to
from dynamics.checks import declared_fields
from dynamics.errors import InputError

# Files that hold the solid of a housing, by how their names end.


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
"""By suffix. CalculiX reads and writes those of Abaqus."""
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
    later=True,
)
FIELD = "mesh_file"
_ALONE = "Write all nodes and elements into one file."
_PART = 4096  # bytes
Fault = tuple[str, str] | None
"""The bound that a content breaks, and what to do."""
MODES = Declared(
    Kind.COUNT,
    "",
    integers(1, 2000),
    "Modes to keep; responses hold to 0.7 of the highest frequency",
    80,
    later=True,
)
ELEMENT_SIZE = Declared(
    Kind.LENGTH,
    "m",
    up_to(20.0),
    "Edge of an element of a STEP file's mesh; left out: the mean wall thickness over 0.7",
    0.014,
    later=True,
)
LOSS_FACTOR = Declared(
    Kind.RATIO,
    "",
    between(0.0, 1.0),
    "Loss factor of the material and its joints",
    0.01,
    later=True,
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


# The content of a mesh file before a reader has it: one file, which names no others and ends.


def mesh_text(content: bytes) -> TextIOWrapper:
    """Return the text of a mesh by lines: a lone carriage return ends one, too."""
    return TextIOWrapper(BytesIO(content), encoding="utf-8", errors="replace")


def check_mesh_content(name: str, content: bytes) -> None:
    """Refuse a mesh that names further files, or on which a reader does not end.

    `name`: of the file; its suffix says the format. Raises `InputError` naming ``mesh_file``.
    """
    find = _FAULTS.get(PurePath(name).suffix.lower())  # other formats name no files
    if find and (fault := find(content)):
        raise InputError(FIELD, name, *fault)


def _of_abaqus(content: bytes) -> Fault:
    """Find INCLUDE by the rule of meshlane: with stars and without, in large letters and small."""
    keywords = (line.partition(",")[0].strip().replace("*", "").upper() for line in mesh_text(content))
    return ("without *INCLUDE: other files are not read", _ALONE) if "INCLUDE" in keywords else None


def _of_nastran(content: bytes) -> Fault:
    """Find INCLUDE, and bulk data without its last line: meshlane waits for it without end."""
    if any(line.lstrip().upper().startswith("INCLUDE") for line in mesh_text(content)):
        return "without INCLUDE: other files are not read", _ALONE
    lines = iter(mesh_text(content))
    begun = any(line.strip().startswith("BEGIN BULK") for line in lines)
    if begun and any(line.startswith("ENDDATA") for line in lines):
        return None
    return "bulk data from BEGIN BULK to ENDDATA", "Export the whole model."


def _of_vtk_xml(content: bytes) -> Fault:
    """Find a document type: it declares entities, which are other files and texts that grow without end."""
    heads: list[str] = []
    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = lambda *_: heads.append("document type")
    parser.StartElementHandler = lambda *_: heads.append("element")
    with suppress(expat.ExpatError, LookupError, ValueError):
        for start in range(0, len(content), _PART):
            parser.Parse(content[start : start + _PART])
            if heads:
                break
    if heads[:1] == ["element"]:
        return None
    return "VTK XML without a document type", "Export it again, as VTU or gmsh (.msh)."


_FAULTS: dict[str, Callable[[bytes], Fault]] = {
    ".inp": _of_abaqus,
    ".bdf": _of_nastran,
    ".nas": _of_nastran,
    ".fem": _of_nastran,
    ".vtu": _of_vtk_xml,
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
    """What a seat's wall does.

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
    """The wall of a bearing seat; where it is follows from its bearing."""

    bore_diameter: float = required(BORE_DIAMETER)
    bore_length: float = required(BORE_LENGTH)
    ring: str = declared(Ring.WEIGHTED_AVERAGE.value, _RING)

    def __post_init__(self) -> None:
        declared_fields(self)
