"""The shafts of the scene: those of the file, planet carriers, stubs of planetary sets; names of parts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from dynamics.shafts import BeamSection, Inertia, hollow_cylinder
from lineofaction.gearbox.from_rexs.gear_unit import GearStage, Part
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.placement import PlacedShaft, Placement
from lineofaction.gearbox.units import MM

LONGEST = 64
"""Characters of a name in a scene."""


class Names:
    """Gives each part of one kind its name.

    A name that is too long, or that another part has, ends in the component's id.
    """

    def __init__(self) -> None:
        self._names: dict[int, str] = {}

    def of(self, part: Part, suffix: str = "") -> str:
        """Return the name of a part; without a suffix the same each time."""
        if not suffix and part.id in self._names:
            return self._names[part.id]
        name = (" ".join(part.name.split()) or part.type) + suffix
        if len(name) > LONGEST or name in self._names.values():
            ending = f" ({part.id}){suffix}"
            name = name[: LONGEST - len(ending)].rstrip() + ending
        self._names[part.id if not suffix else -len(self._names) - 1] = name
        return name


# The rigid body of a planet carrier: the inertia of its shafts, pins and side plates together.


DISC = 0.02
"""m, the length of a carrier without sizes."""
_SIZES = ("outer_diameter", "inner_diameter", "length")


@dataclass(frozen=True)
class _Piece:
    """A body of revolution at z (m), off the axis by `radius` (m), from `begin` to `end`."""

    inertia: Inertia
    z: float
    radius: float
    begin: float
    end: float


def _carrier_body(layout: Layout, rotor: int) -> dict[str, Any]:
    """Return the body of a carrier.

    Its axis is that of the first shaft that is no pin. A piece off the axis adds m r^2 about it and, as one
    of several around it, m r^2 / 2 across it.
    """
    pins = {pin.id for planets in layout.rotors.sets for pin in planets.pins}
    shafts = [member for member in layout.rotors.members(rotor) if member in layout.shafts]
    axis = layout.shafts[next((member for member in shafts if member not in pins), shafts[0])]
    x, y = (float(value) for value in axis.origin[:2])
    members = (layout.unit.part(member) for member in layout.rotors.members(rotor))
    pieces = [piece for member in members for piece in _pieces(layout, member, (x, y))]
    if not pieces:
        return _disc(layout, axis, rotor)
    mass = sum(piece.inertia.mass for piece in pieces)
    center = sum(piece.inertia.mass * piece.z for piece in pieces) / mass
    polar = sum(p.inertia.polar + p.inertia.mass * p.radius**2 for p in pieces)
    across = sum(
        p.inertia.transverse + p.inertia.mass * (0.5 * p.radius**2 + (p.z - center) ** 2) for p in pieces
    )
    half = max(max(center - p.begin, p.end - center) for p in pieces)
    return _rigid((x, y, center - half), 2.0 * half, Inertia(mass, polar, across))


def _disc(layout: Layout, axis: PlacedShaft, rotor: int) -> dict[str, Any]:
    """Return a steel disc of the circle of the planets' axes, where no part of the carrier has a size."""
    planets = next(s.planets for s in layout.rotors.sets if layout.rotor(s.carrier[0].id) == rotor)
    placed = [layout.shafts[planet.id] for planet in planets if planet.id in layout.shafts]
    x, y, z = (float(value) for value in axis.origin)
    radius = max((math.hypot(p.origin[0] - x, p.origin[1] - y) for p in placed), default=0.0) or DISC
    words = f"no part has a size: a steel disc of {2e3 * radius:.6g} mm diameter, {DISC * 1e3:g} mm long"
    layout.unit.part(rotor).say("inertia", "defaulted", words)
    return _rigid((x, y, z), DISC, hollow_cylinder(2.0 * radius, DISC))


def _pieces(layout: Layout, part: Part, axis: tuple[float, float]) -> Iterator[_Piece]:
    if part.id in layout.shafts:
        shaft = layout.shafts[part.id]
        radius = math.hypot(shaft.origin[0] - axis[0], shaft.origin[1] - axis[1])
        left = float(shaft.origin[2])
        for section in shaft.sections:
            inertia, z = section.body
            yield _Piece(inertia, left + z, radius, left, left + section.length)
            left += section.length
        return
    place = Placement.of(part)
    outer, bore, length = (part.number(item, "size of the side plate, mm") for item in _SIZES)
    if place is None or not outer or not length or (bore or 0.0) >= outer:
        part.say("", "refused", "a side plate needs its place, diameters and length; its mass is left out")
        return
    z = float(layout.axes.point(place.origin)[2])
    begin, end = sorted((z, z + layout.axes.sense(place) * length))
    part.say("", "derived", "inertia of the planet carrier")
    yield _Piece(hollow_cylinder(outer, length, bore or 0.0), 0.5 * (begin + end), 0.0, begin, end)


STUB = 1e-3
"""m; a stub has neither mass nor an elastic part, so its length is of no account."""


@dataclass(frozen=True)
class SceneShaft:
    """A shaft of the scene."""

    name: str
    """Its name there."""
    rotor: int
    """The rotor that it is, or belongs to."""
    table: dict[str, Any]
    """Its table in a scene file."""

    @property
    def begin(self) -> float:
        """Left end in z, m."""
        return float(self.table["origin_mm"][2]) * MM

    def seat(self, name: str, z: float) -> dict[str, Any]:
        """Return the table of what stands on the shaft at a z, m."""
        return {"name": name, "shaft": self.name, "position_mm": self.position_mm(z)}

    def position_mm(self, z: float) -> float:
        """Return the position of a z from the left end, mm; within the shaft."""
        return min(max((z - self.begin) / MM, 0.0), float(self.table["length_mm"]))


@dataclass(frozen=True)
class SceneShafts:
    """All shafts of the scene."""

    by_rotor: dict[int, SceneShaft]
    """The shaft of each rotor."""
    stages: tuple[GearStage, ...]
    """The stages that the scene has: of equal planets those of the first."""
    stubs: dict[int, SceneShaft] = field(default_factory=dict)
    """By gear: the stub on which a gear of a set stands whose shaft also meshes outside of the set."""

    @classmethod
    def of(cls, layout: Layout, stages: Sequence[GearStage], names: Names) -> SceneShafts:
        """Return the shafts that computed stages and couplings make parts of one train."""
        first = {planets.planets[0].id for planets in layout.rotors.sets}
        others = {shaft.id for planets in layout.rotors.sets for shaft in planets.planets} - first
        kept = tuple(s for s in stages if not others & {shaft.id for shaft in s.shafts})
        rotors = _joined(layout, kept)
        bodies = cls({rotor: _shaft(layout, rotor, names) for rotor in sorted(rotors)}, kept)
        for placed in layout.shafts.values():
            if placed.part.id not in others and layout.rotor(placed.part.id) not in rotors:
                placed.part.say("", "refused", "no computed stage or coupling joins it to the train")
        for stage in (each for each in kept if layout.carrier(each) is not None):
            for gear, shaft in zip(stage.gears, stage.shafts, strict=True):
                meshing = (each for each in kept if shaft.id in {own.id for own in each.shafts})
                if len(set(map(layout.carrier, meshing))) > 1:
                    bodies.stubs[gear.id] = _stub(layout, shaft, gear, names)
        _enter_frames(layout, bodies)
        return bodies

    @property
    def all(self) -> tuple[SceneShaft, ...]:
        """Shafts and stubs."""
        return (*self.by_rotor.values(), *self.stubs.values())


def _joined(layout: Layout, stages: Sequence[GearStage]) -> set[int]:
    """Return the rotors of the stages, their carriers, and what is coupled to them."""
    rotors: set[int] = set().union(*map(layout.joined, stages))
    known: set[int] = set()
    while rotors != known:
        known = set(rotors)
        for entry in layout.rotors.couplings:
            ends = {layout.rotor(entry.inner.id), layout.rotor(entry.outer.id)}
            if ends & rotors and {entry.inner.id, entry.outer.id} <= set(layout.shafts):
                rotors |= ends
    return rotors


def _shaft(layout: Layout, rotor: int, names: Names) -> SceneShaft:
    part = layout.unit.part(rotor)
    if rotor in {layout.rotor(planets.carrier[0].id) for planets in layout.rotors.sets}:
        body = _carrier_body(layout, rotor)
        members = layout.rotors.members(rotor)
        for member in members:
            words = f"part of the rigid planet carrier of {len(members)} parts"
            layout.unit.part(member).say("", "derived", words)
    else:
        placed = layout.shafts[rotor]
        part.say("", "taken", f"shaft of the scene, {'u along z' if placed.sense > 0 else 'u against z'}")
        body = _body(placed, part)
    return SceneShaft(names.of(part), rotor, {"name": names.of(part), **body})


def _body(placed: PlacedShaft, part: Part) -> dict[str, Any]:
    """Return place, length and sections of a shaft; without sections it is rigid and has no mass."""
    origin = tuple(map(float, placed.origin))
    if not placed.sections:
        part.say("shaft_section", "defaulted", "no sections: a rigid shaft without mass")
        return _rigid(origin, 1.0, Inertia())
    sections = [_section(section) for section in placed.sections]
    return _line(origin, placed.length) | {"sections": sections}


def _section(section: BeamSection) -> dict[str, Any]:
    """Return the table of a section; steel is not written out."""
    steel = BeamSection(section.length, section.outer_diameter)
    table: dict[str, Any] = {
        "length_mm": section.length / MM,
        "outer_diameter_mm": section.outer_diameter / MM,
        "bore_diameter_mm": section.bore_diameter / MM,
    }
    if section.end_outer_diameter is not None:
        table["end_outer_diameter_mm"] = section.outer_diameters[1] / MM
        table["end_bore_diameter_mm"] = section.bore_diameters[1] / MM
    material = {"youngs_modulus": "_gpa", "poissons_ratio": "", "density": "_kg_per_m3"}
    for name, unit in material.items():
        if (value := getattr(section, name)) != getattr(steel, name):
            table[f"{name}{unit}"] = value / 1e9 if unit == "_gpa" else value
    return table


def _stub(layout: Layout, shaft: Part, gear: Part, names: Names) -> SceneShaft:
    placed = layout.shafts[shaft.id]
    z = layout.z_on(placed, gear)
    x, y = map(float, placed.origin[:2])
    name = names.of(shaft, " stub")
    gear.say("", "derived", f"on a stub of its shaft in the carrier's frame, {name}")
    table = _rigid((x, y, z - 0.5 * STUB), STUB, Inertia())
    return SceneShaft(name, layout.rotor(shaft.id), {"name": name, **table})


def _line(origin: Sequence[float], length: float) -> dict[str, Any]:
    return {"length_mm": length / MM, "origin_mm": [value / MM for value in origin]}


def _rigid(origin: Sequence[float], length: float, inertia: Inertia) -> dict[str, Any]:
    """Return a rigid body along its axis; its center of mass is at mid-length."""
    return _line(origin, length) | {"inertia": inertia_table(inertia)}


def _enter_frames(layout: Layout, shafts: SceneShafts) -> None:
    """Describe the members of planetary sets in the frame of their carrier."""
    for stage in shafts.stages:
        carrier = layout.carrier(stage)
        if carrier is None:
            continue
        frame = shafts.by_rotor[carrier]
        frame.table["frame"] = frame.name
        for gear, shaft in zip(stage.gears, stage.shafts, strict=True):
            member = shafts.stubs.get(gear.id) or shafts.by_rotor[layout.rotor(shaft.id)]
            member.table["frame"] = frame.name


def inertia_table(inertia: Inertia) -> dict[str, float]:
    """Return the table of an inertia."""
    return {"mass_kg": inertia.mass, "polar_kg_m2": inertia.polar, "transverse_kg_m2": inertia.transverse}
