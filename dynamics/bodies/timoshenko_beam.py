"""Beam elements of a stepped shaft after Timoshenko: bending with shear, torsion, tension."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bounds import Declared, Kind, Text, above, below, between, declared, described, required, up_to
from dynamics.bodies.shaft_position import SAME_POSITION, nearest_on, on_length
from dynamics.bodies.steel import STEEL_DENSITY, STEEL_POISSON_RATIO, STEEL_YOUNGS_MODULUS
from dynamics.checks import declared_fields, finite
from dynamics.errors import InputError
from dynamics.types import FloatArray, IntArray

PER_NODE = 6
"""Freedoms of a node: x, y, z, tilt_x, tilt_y, rotation about z."""

_LENGTH = Declared(Kind.LENGTH, "m", up_to(1000.0), "Length", 0.08)
_OUTER = Declared(Kind.LENGTH, "m", up_to(100.0), "Outer diameter", 0.04)
_BORE = Declared(Kind.LENGTH, "m", between(0.0, 100.0), "Bore; 0: solid", 0.01)
_YOUNG = Declared(Kind.STIFFNESS, "Pa", up_to(1e18), "Young's modulus", 210e9)
_POISSON = Declared(Kind.RATIO, "", between(0.0, 0.499), "Poisson's ratio", 0.3)
_DENSITY = Declared(Kind.INERTIA, "kg/m^3", up_to(1e6), "Density", 7850.0)


@described
@dataclass(frozen=True)
class BeamSection:
    """A cylindrical piece of a shaft, of steel unless its material is given."""

    length: float = required(_LENGTH)
    outer_diameter: float = required(_OUTER)
    bore_diameter: float = declared(0.0, _BORE)
    youngs_modulus: float = declared(STEEL_YOUNGS_MODULUS, _YOUNG)
    poissons_ratio: float = declared(STEEL_POISSON_RATIO, _POISSON)
    density: float = declared(STEEL_DENSITY, _DENSITY)

    def __post_init__(self) -> None:
        declared_fields(self)
        if self.bore_diameter >= self.outer_diameter:
            bound = below(self.outer_diameter, "m", "the outer diameter")
            raise InputError("bore_diameter", self.bore_diameter, bound)

    @property
    def area(self) -> float:
        """m^2."""
        return math.pi / 4.0 * (self.outer_diameter**2 - self.bore_diameter**2)

    @property
    def second_moment(self) -> float:
        """Of the area about an axis across, m^4."""
        return math.pi / 64.0 * (self.outer_diameter**4 - self.bore_diameter**4)

    @property
    def shear_modulus(self) -> float:
        """Pa."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))

    @property
    def shear_coefficient(self) -> float:
        """Share of the area that carries shear: Cowper, J. Appl. Mech. 33 (1966) 335-340, hollow circle."""
        nu, square = self.poissons_ratio, (self.bore_diameter / self.outer_diameter) ** 2
        whole = (1.0 + square) ** 2
        return 6.0 * (1.0 + nu) * whole / ((7.0 + 6.0 * nu) * whole + (20.0 + 12.0 * nu) * square)


@dataclass(frozen=True)
class TimoshenkoBeam:
    """N nodes of six freedoms each, node by node; free in space.

    Attributes
    ----------
    position : (N,) array
        Along z from the left end, m.
    mass, stiffness : (6 N, 6 N) arrays
        Symmetric; kg, N/m and with m, rad.
    """

    position: FloatArray
    mass: FloatArray
    stiffness: FloatArray

    def freedoms(self, position: float) -> IntArray:
        """Return the indices of the six freedoms of the node at `position` (m)."""
        node = int(np.argmin(np.abs(self.position - position)))
        if abs(self.position[node] - position) > SAME_POSITION * self.position[-1]:
            raise InputError("position", position, "at a node", "Name it as a station of the beam.")
        return np.arange(PER_NODE * node, PER_NODE * node + PER_NODE, dtype=np.int64)


def timoshenko_beam(
    sections: Sequence[BeamSection], stations: Sequence[float] = (), longest: float = math.inf
) -> TimoshenkoBeam:
    """Return the beam of `sections` from left to right.

    Two-node elements whose shape functions solve the static equations between nodes: deflections under
    forces at nodes are exact. Shear is constant in an element, so natural frequencies converge with the
    square of its length in their part that shear makes, with the fourth power in the rest.
    Rotary inertia and shear are in the consistent mass (Przemieniecki, Theory of Matrix Structural Analysis,
    1968).

    Parameters
    ----------
    sections : sequence of BeamSection
    stations : sequence of float
        Positions where forces act, m from the left end; each becomes a node.
    longest : float
        No element is longer, m.

    Raises
    ------
    InputError
        Without a section, for a station off the beam, or for a `longest` that is not above zero.
    """
    if not sections:
        raise InputError("sections", 0, "at least one section")
    if not longest > 0.0:
        raise InputError("longest", longest, above(0.0))
    ends = np.cumsum([0.0, *(section.length for section in sections)])
    length = float(ends[-1])
    for index, station in enumerate(stations):
        if not on_length(finite(f"stations[{index}]", station), length):
            bound = Text.of("on the beam, ", between(0.0, length, "m"))
            raise InputError(f"stations[{index}]", station, bound)
    node = _nodes(ends, [nearest_on(station, length) for station in stations], longest)
    size = PER_NODE * node.size
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    for k, (left, right) in enumerate(pairwise(node)):
        piece = int(np.searchsorted(ends, 0.5 * (left + right), side="right")) - 1
        rows = slice(PER_NODE * k, PER_NODE * k + 2 * PER_NODE)
        m, s = _element(sections[piece], float(right - left))
        mass[rows, rows] += m
        stiffness[rows, rows] += s
    return TimoshenkoBeam(node, mass, stiffness)


def _nodes(ends: FloatArray, stations: Sequence[float], longest: float) -> FloatArray:
    """Return ends of sections, stations, and equal parts between them where these are too long."""
    positions = np.sort(np.concatenate([ends, np.asarray(stations, dtype=float)]))
    apart = np.concatenate([[True], np.diff(positions) > SAME_POSITION * ends[-1]])
    nodes = positions[apart]
    parts = []
    for left, right in pairwise(nodes):
        count = max(math.ceil((right - left) / longest * (1.0 - SAME_POSITION)), 1)
        parts.append(np.linspace(left, right, count, endpoint=False))
    return np.concatenate([*parts, nodes[-1:]])


def _element(section: BeamSection, length: float) -> tuple[FloatArray, FloatArray]:
    """Mass and stiffness (12, 12) of an element."""
    mass, stiffness = np.zeros((12, 12)), np.zeros((12, 12))
    bent_mass, bent = _bending(section, length)
    # u_x' = tilt_y, u_y' = -tilt_x
    for columns, slope in (((0, 4, 6, 10), 1.0), ((1, 3, 7, 9), -1.0)):
        sign = np.array([1.0, slope, 1.0, slope])
        mass[np.ix_(columns, columns)] = sign[:, None] * bent_mass * sign
        stiffness[np.ix_(columns, columns)] = sign[:, None] * bent * sign
    polar = 2.0 * section.second_moment
    pull = np.array([[1.0, -1.0], [-1.0, 1.0]]) / length
    share = section.density * length / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    axial, torsion = np.ix_((2, 8), (2, 8)), np.ix_((5, 11), (5, 11))
    stiffness[axial], mass[axial] = section.youngs_modulus * section.area * pull, section.area * share
    stiffness[torsion], mass[torsion] = section.shear_modulus * polar * pull, polar * share
    return mass, stiffness


def _bending(section: BeamSection, length: float) -> tuple[FloatArray, FloatArray]:
    """Mass and stiffness (4, 4) in one plane: deflection and its slope at both ends."""
    bent = section.youngs_modulus * section.second_moment
    shear = section.shear_coefficient * section.shear_modulus * section.area
    p = 12.0 * bent / (shear * length**2)
    near, far = 4.0 + p, 2.0 - p
    ends = [12.0, 6.0, -12.0, 6.0]
    stiffness = np.array([ends, [6.0, near, -6.0, far], [-value for value in ends], [6.0, far, -6.0, near]])
    a, b = 13.0 / 35.0 + 0.7 * p + p * p / 3.0, 11.0 / 210.0 + 11.0 * p / 120.0 + p * p / 24.0
    c, d = 9.0 / 70.0 + 0.3 * p + p * p / 6.0, -(13.0 / 420.0 + 3.0 * p / 40.0 + p * p / 24.0)
    e, f = 1.0 / 105.0 + p / 60.0 + p * p / 120.0, -(1.0 / 140.0 + p / 60.0 + p * p / 120.0)
    moved = np.array([[a, b, c, d], [b, e, -d, f], [c, -d, a, -b], [d, f, -b, e]])
    g, h = 1.2, 0.1 - 0.5 * p
    i, j = 2.0 / 15.0 + p / 6.0 + p * p / 3.0, -1.0 / 30.0 - p / 6.0 + p * p / 6.0
    turned = np.array([[g, h, -g, h], [h, i, -h, j], [-g, -h, g, -h], [h, j, -h, i]])
    per = np.array([1.0, length, 1.0, length])
    scale = per[:, None] * per / (1.0 + p)
    mass = section.density * (section.area * length * moved + section.second_moment / length * turned)
    return mass * scale / (1.0 + p), stiffness * scale * bent / length**3
