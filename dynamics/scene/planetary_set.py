"""A planetary gear set from its numbers: shafts, gears, bearings and meshes with their exact phases."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain

from bounds import Quantity, SiNote, Text
from dynamics.bearings import BearingStiffness, Bushing, PlanetBearing
from dynamics.checks import finite, integer, one_of, positive
from dynamics.errors import InputError
from dynamics.meshes import GearMesh, MeshTable
from dynamics.shafts import GearBody, Inertia, Shaft

TOOTH_FIT = 1e-6  # in teeth: largest misfit of a planet's teeth in both central gears by its angle


Stiffness = BearingStiffness | float | None


@dataclass(frozen=True)
class _PlanetaryParts:
    """Parts of a scene, to be joined with those of other trains: ``Scene((*parts.shafts, other), ...)``."""

    shafts: tuple[Shaft, ...]
    gears: tuple[GearBody, ...]
    bushings: tuple[Bushing, ...]
    planet_bearings: tuple[PlanetBearing, ...]
    meshes: tuple[GearMesh, ...]


@dataclass(frozen=True)
class PlanetarySet:
    """A sun, N planets on a carrier, and a ring gear; all described in the carrier's rotating frame.

    Shafts and gears are called sun, ring, carrier, planet 1 ... planet N, meshes sun-planet 1 ...,
    ring-planet 1 ..., each behind ``name`` and a dot if that is not empty. Every gear sits in the middle of
    its shaft, with its bearing at the same position. Drives, free rotations and loads are the scene's.
    """

    teeth: tuple[int, int, int]
    """Numbers of teeth of sun, planet, ring."""
    base_radius: tuple[float, float, float]
    """Base radii of sun, planet, ring, m."""
    center_distance: float
    """Distance from the carrier's axis to a pin, m."""
    face_width: float
    """Face width of all gears, m."""
    sun_table: MeshTable
    ring_table: MeshTable
    """`sun_table`, `ring_table`: Tables of the sun-planet and the ring-planet mesh."""
    planets: int
    """Number N of planets."""
    sun_inertia: Inertia
    planet_inertia: Inertia
    ring_inertia: Inertia
    carrier_inertia: Inertia
    """`sun_inertia`, `planet_inertia`, `ring_inertia`, `carrier_inertia`: Inertias of the members; the
    carrier's is without planets.
    """
    angles: tuple[float, ...] | None = None
    """Angles of the pins about +z, rad; None: equally spaced from 0."""
    base_helix_angle: float = 0.0
    """Base helix angle of the sun, rad; > 0: right hand."""
    sun_stiffness: Stiffness = None
    ring_stiffness: Stiffness = None
    carrier_stiffness: Stiffness = None
    """`sun_stiffness`, `ring_stiffness`, `carrier_stiffness`: Stiffnesses of the central members' bearings,
    isotropic across the axis; a number: radial alone, N/m. None: fixed rigidly. Small: floating. A bearing
    without axial or tilt stiffness is rigid in that direction.
    """
    planet_stiffness: Stiffness = None
    """Stiffness of the planet bearings, stated as for the central members."""
    damping_ratio: float = 0.05
    """Damping ratio of all bearings and meshes for which no damping is stated."""
    pin_errors: tuple[tuple[float, float], ...] | None = None
    """Displacement of each pin from its nominal position, m."""
    driver: str = "sun"
    """``"sun"``: the sun drives the planets and these the ring (or react on it); ``"ring"``: the reverse."""
    ring_phase: float | None = None
    """Position of a planet's ring mesh less that of its sun mesh, base pitches (see `ring_phase`). None: the
    phase of planets whose teeth are as thick as their spaces.
    """
    technique: str = "variable_torque"
    """Technique of all meshes."""
    name: str = ""
    """Name of the set, in front of the names of its parts."""
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Left end of the carrier's axis in the fixed frame, m."""

    def __post_init__(self) -> None:
        for label, count in zip(("sun", "planet", "ring"), self.teeth, strict=True):
            integer(f"teeth.{label}", count, 1, 100_000)
        for label in ("center_distance", "face_width"):
            positive(label, getattr(self, label))
        integer("planets", self.planets, 1, 100)
        if self.ring_phase is not None:
            finite("ring_phase", self.ring_phase)
        one_of("driver", self.driver, ("sun", "ring"))
        for label in ("angles", "pin_errors"):
            values = getattr(self, label)
            if values is not None and len(values) != self.planets:
                raise InputError(label, len(values), f"one for each of the {self.planets} planets")
        self._check_assembly()

    def _check_assembly(self) -> None:
        """Every planet's teeth fit those of sun and ring: (z_s + z_r) psi / (2 pi) is an integer."""
        both = self.teeth[0] + self.teeth[2]
        for index, turn in enumerate(self.turns):
            off = float(both * turn - round(both * turn))
            if abs(off) <= TOOTH_FIT:
                continue
            nearest = 2.0 * math.pi * round(both * turn) / both
            if self.angles is None:
                bound = f"a divisor of z_sun + z_ring = {both}, for planets equally spaced"
                raise InputError(
                    "planets", self.planets, bound, "Change tooth numbers or give the pins' angles."
                )
            bound = f"a multiple of 2 pi / (z_sun + z_ring) = 2 pi / {both}"
            degrees = SiNote(f" ({math.degrees(nearest):.6g} deg)")
            suggestion = Text.of("The nearest is ", Quantity(nearest, "rad", digits=9), degrees, ".")
            raise InputError(f"angles[{index}]", self.angles[index], bound, suggestion)

    @property
    def turns(self) -> tuple[Fraction | float, ...]:
        """Angles of the pins in revolutions: exact where equally spaced."""
        if self.angles is None:
            return tuple(Fraction(index, self.planets) for index in range(self.planets))
        return tuple(angle / (2.0 * math.pi) for angle in self.angles)

    def called(self, part: str) -> str:
        """Return the full name of a part."""
        return f"{self.name}.{part}" if self.name else part

    def parts(self) -> _PlanetaryParts:
        """Return the parts of the set."""
        planets = [self._planet(index) for index in range(self.planets)]
        names, inertias = ("sun", "ring", "carrier"), (Inertia(),) * 2 + (self.carrier_inertia,)
        central = [
            Shaft(self.called(name), self.face_width, self.position, inertia, self.called("carrier"))
            for name, inertia in zip(names, inertias, strict=True)
        ]
        gears = [
            self._gear("sun", 0, self.sun_inertia, 1.0),
            self._gear("ring", 2, self.ring_inertia, -1.0),
            *(self._gear(f"planet {i + 1}", 1, self.planet_inertia, -1.0) for i in range(self.planets)),
        ]
        stiffness = (self.sun_stiffness, self.ring_stiffness, self.carrier_stiffness)
        bushings = [
            self._bushing(name, _in_full(values))
            for name, values in zip(names, stiffness, strict=True)
            if values is not None
        ]
        pins = range(self.planets if self.planet_stiffness is not None else 0)
        return _PlanetaryParts(
            (*central, *planets),
            tuple(gears),
            tuple(bushings),
            tuple(self._bearing(index, _in_full(self.planet_stiffness)) for index in pins),
            tuple(chain.from_iterable(self._meshes(index) for index in range(self.planets))),
        )

    def _planet(self, index: int) -> Shaft:
        angle = 2.0 * math.pi * float(self.turns[index])
        x, y, z = self.position
        x, y = x + self.center_distance * math.cos(angle), y + self.center_distance * math.sin(angle)
        carrier = self.called("carrier")
        return Shaft(self.called(f"planet {index + 1}"), self.face_width, (x, y, z), frame=carrier)

    def _gear(self, name: str, member: int, inertia: Inertia, hand: float) -> GearBody:
        """Return a gear; sun and planets are of opposite hand, planets and ring of the same."""
        return GearBody(
            name=self.called(name),
            shaft=self.called(name),
            position=self.face_width / 2.0,
            teeth=self.teeth[member],
            base_radius=self.base_radius[member],
            face_width=self.face_width,
            base_helix_angle=hand * self.base_helix_angle,
            inertia=inertia,
            internal=member == 2,
        )

    def _bushing(self, name: str, stiffness: BearingStiffness) -> Bushing:
        return Bushing(
            self.called(f"{name} bearing"),
            self.called(name),
            self.face_width / 2.0,
            stiffness.radial,
            stiffness.axial,
            damping_ratio=self.damping_ratio,
            stiffness=stiffness.matrix,
        )

    def _bearing(self, index: int, stiffness: BearingStiffness) -> PlanetBearing:
        radial, tangential = self.pin_errors[index] if self.pin_errors is not None else (0.0, 0.0)
        return PlanetBearing(
            self.called(f"planet {index + 1} bearing"),
            self.called(f"planet {index + 1}"),
            self.called("carrier"),
            self.face_width / 2.0,
            stiffness.radial,
            stiffness.axial,
            damping_ratio=self.damping_ratio,
            radial_error=radial,
            tangential_error=tangential,
            stiffness=stiffness.matrix,
        )

    def _meshes(self, index: int) -> tuple[GearMesh, GearMesh]:
        """Return both meshes of a planet; those of the first one state how its ring mesh is ahead."""
        planet = self.called(f"planet {index + 1}")
        phase_specified = index == 0 and self.ring_phase is not None
        flow = (self.called("sun"), planet), (planet, self.called("ring"))
        if self.driver == "ring":
            flow = (planet, self.called("sun")), (self.called("ring"), planet)
        details = (
            ("sun", self.sun_table, 0.0 if phase_specified else None),
            ("ring", self.ring_table, self.ring_phase if phase_specified else None),
        )
        first, second = (
            GearMesh(
                self.called(f"{central}-planet {index + 1}"),
                driver,
                driven,
                table,
                self.technique,
                damping_ratio=self.damping_ratio,
                position_offset=offset,
            )
            for (driver, driven), (central, table, offset) in zip(flow, details, strict=True)
        )
        return first, second


def _in_full(stiffness: Stiffness) -> BearingStiffness:
    return stiffness if isinstance(stiffness, BearingStiffness) else BearingStiffness(stiffness or 0.0)


def ring_phase(
    planet_teeth: int, half_angles: tuple[float, float] | None = None, driver: str = "sun"
) -> float:
    """Return position of the ring mesh less that of the sun mesh of one planet, base pitches in [0, 1).

    The sun touches one flank of the planet's teeth on the side of the sun, the ring the other flank on the
    opposite side: half the planet's teeth and one tooth thickness lie between.

    Parameters
    ----------
    half_angles : tuple of two floats, optional
        Half the planet's tooth thickness angle on its working pitch circles with sun and ring, rad: with
        psi_b that on the base circle, psi_b - inv(working pressure angle). Left out: pi / (2 z) each,
        thickness = space.
    driver : str
        ``"sun"`` or ``"ring"``, as in `PlanetarySet`.
    """
    thickness = 0.5 if half_angles is None else planet_teeth * sum(half_angles) / (2.0 * math.pi)
    ahead = thickness - planet_teeth / 2.0
    return (ahead if driver == "sun" else -ahead) % 1.0
