"""Shafts of a scene file, and the discs on them, in the terms of dynamics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from dynamics.bodies import BeamSection, DiscBody, Inertia, Shaft, hollow_cylinder
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.declared import declared_part, in_si
from lineofaction.gearbox.convert.errors import named
from lineofaction.gearbox.schemas.scene_discs import DiscInput
from lineofaction.gearbox.schemas.scene_shafts import ShaftInput
from lineofaction.gearbox.units import MM


def shaft_of(index: int, shaft: ShaftInput) -> Shaft:
    """Return a shaft; a diameter is one section of steel, an inertia alone is rigid."""
    x, y, z = shaft.origin_mm
    sections = _sections(index, shaft)
    with named(f"shafts[{index}]"):
        return Shaft(
            name=shaft.name,
            origin=(x * MM, y * MM, z * MM),
            inertia=declared_part(Inertia, shaft.inertia, "inertia") or Inertia(),
            frame=shaft.frame,
            sections=sections,
            **in_si(Shaft, shaft),
        )


def _sections(index: int, shaft: ShaftInput) -> tuple[BeamSection, ...]:
    """Return the pieces; their lengths, which agree with the shaft's, to the last digit."""
    if shaft.diameter_mm is not None:
        return (BeamSection(shaft.length_mm * MM, shaft.diameter_mm * MM),)
    parts = shaft.sections or ()
    together = sum(part.length_mm for part in parts)
    sections = []
    for number, part in enumerate(parts):
        with named(f"shafts[{index}].sections[{number}]"):
            length = part.length_mm * (shaft.length_mm / together) * MM
            sections.append(BeamSection(**in_si(BeamSection, part) | {"length": length}))
    return tuple(sections)


def disc_of(index: int, disc: DiscInput) -> DiscBody:
    """Return a disc."""
    field = f"discs[{index}]"
    with named(field):
        inertia = declared_part(Inertia, disc.inertia, "inertia") or Inertia()
        placed = DiscBody(disc.name, disc.shaft, inertia=inertia, **in_si(DiscBody, disc))
    if disc.cylinder is None:
        return placed
    size = disc.cylinder
    with named(f"{field}.cylinder"):
        steel = hollow_cylinder(size.outer_diameter_mm * MM, size.width_mm * MM, size.bore_diameter_mm * MM)
        return replace(placed, inertia=steel)


def has_bent_shafts(database: SteDatabase) -> bool:
    """Return whether a table has the bending of its gears' shafts in it."""
    ledger = database.metadata.effect_ledger
    entries = ledger if isinstance(ledger, list) else ledger.get("entries", [])
    return any(
        isinstance(e, Mapping) and e.get("name") == "shaft_deflection" and e.get("on") for e in entries
    )
