"""The shafts of the scene: shafts of the file, planet carriers, stubs of planetary sets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from dynamics.shafts import BeamSection, Inertia
from lineofaction.gearbox.from_rexs.carrier_body import carrier_body, rigid_line, rigid_section
from lineofaction.gearbox.from_rexs.gear_unit import GearStage, Part
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.part_names import Names
from lineofaction.gearbox.from_rexs.placed_shafts import PlacedShaft
from lineofaction.gearbox.units import MM

STUB = 1e-3
"""Length of a stub, m. A stub has neither mass nor an elastic part, so its length has no effect."""


@dataclass(frozen=True)
class SceneShaft:
    """A shaft of the scene."""

    name: str
    """Name of the shaft in the scene."""
    rotor: int
    """Rotor that the shaft is, or belongs to."""
    table: dict[str, Any]
    """Table of the shaft in a scene file."""

    @property
    def begin(self) -> float:
        """Left end in z, m."""
        return float(self.table["origin_mm"][2]) * MM

    def seat(self, name: str, z: float) -> dict[str, Any]:
        """Return the table of a part on the shaft at a z, m."""
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
    """Stages of the scene: of equal planets only the stages of the first."""
    stubs: dict[int, SceneShaft] = field(default_factory=dict)
    """Stubs by gear: a gear of a planetary set whose shaft also meshes outside of the set stands on a stub.
    """

    @classmethod
    def of(cls, layout: Layout, stages: Sequence[GearStage], names: Names) -> SceneShafts:
        """Return the shafts that computed stages and couplings make parts of one train."""
        first = {planets.planets[0].id for planets in layout.rotors.sets}
        others = {shaft.id for planets in layout.rotors.sets for shaft in planets.planets} - first
        complete = tuple(s for s in stages if not others & {shaft.id for shaft in s.shafts})
        rotors = _joined(layout, complete)
        bodies = cls({rotor: _shaft(layout, rotor, names) for rotor in sorted(rotors)}, complete)
        for placed in layout.shafts.values():
            if placed.part.id not in others and layout.rotor(placed.part.id) not in rotors:
                placed.part.say("", "refused", "no computed stage or coupling joins it to the train")
        for stage in complete:
            if layout.carrier(stage) is None:
                continue
            for gear, shaft in zip(stage.gears, stage.shafts, strict=True):
                meshing = [s for s in complete if shaft.id in {member.id for member in s.shafts}]
                if len({layout.carrier(s) for s in meshing}) > 1:
                    bodies.stubs[gear.id] = _stub(layout, shaft, gear, names)
        _enter_frames(layout, bodies)
        return bodies

    @property
    def all(self) -> tuple[SceneShaft, ...]:
        """Shafts and stubs."""
        return (*self.by_rotor.values(), *self.stubs.values())


def _joined(layout: Layout, stages: Sequence[GearStage]) -> set[int]:
    """Return the rotors of the stages, their carriers, and the rotors coupled to them."""
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
        body = carrier_body(layout, rotor)
        members = layout.rotors.members(rotor)
        for member in members:
            text = f"part of the rigid planet carrier of {len(members)} parts"
            layout.unit.part(member).say("", "derived", text)
    else:
        placed = layout.shafts[rotor]
        part.say("", "taken", f"shaft of the scene, {'u along z' if placed.sense > 0 else 'u against z'}")
        body = _body(placed, part)
    return SceneShaft(names.of(part), rotor, {"name": names.of(part), **body})


def _body(shaft: PlacedShaft, part: Part) -> dict[str, Any]:
    """Return place, length and sections of a shaft; without sections it is rigid and has no mass."""
    origin = tuple(map(float, shaft.origin))
    if not shaft.sections:
        part.say("shaft_section", "defaulted", "no sections: a rigid shaft without mass")
        return rigid_section(origin, 1.0, Inertia())
    sections = [_section(section) for section in shaft.sections]
    return rigid_line(origin, shaft.length) | {"sections": sections}


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
    table = rigid_section((x, y, z - 0.5 * STUB), STUB, Inertia())
    return SceneShaft(name, layout.rotor(shaft.id), {"name": name, **table})


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
