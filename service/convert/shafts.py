"""Shafts of a scene file in the terms of dynamics."""

from __future__ import annotations

from collections.abc import Mapping

from dynamics.bodies import BeamSection, Inertia, Shaft
from fe_contact.ste import SteDatabase
from service.convert.errors import named
from service.schemas.scene_bodies import InertiaInput
from service.schemas.scene_shafts import SectionInput, ShaftInput
from service.units import MM

GPA = 1e9


def shaft_of(index: int, shaft: ShaftInput) -> Shaft:
    """Return a shaft; a diameter is one section of steel, an inertia alone is rigid."""
    x, y, z = shaft.origin_mm
    sections = _sections(index, shaft)
    with named(f"shafts[{index}]"):
        return Shaft(
            shaft.name,
            shaft.length_mm * MM,
            (x * MM, y * MM, z * MM),
            _inertia(shaft.inertia),
            shaft.frame,
            sections,
            shaft.damping_ratio,
        )


def _inertia(part: InertiaInput | None) -> Inertia:
    """Return the inertia of a rigid shaft."""
    return Inertia() if part is None else Inertia(part.mass_kg, part.polar_kg_m2, part.transverse_kg_m2)


def _sections(index: int, shaft: ShaftInput) -> tuple[BeamSection, ...]:
    """Return the pieces; their lengths, which agree with the shaft's, to the last digit."""
    if shaft.diameter_mm is not None:
        return (BeamSection(shaft.length_mm * MM, shaft.diameter_mm * MM),)
    parts = shaft.sections or ()
    together = sum(part.length_mm for part in parts)
    sections = []
    for number, part in enumerate(parts):
        with named(f"shafts[{index}].sections[{number}]"):
            sections.append(_section(part, part.length_mm * (shaft.length_mm / together) * MM))
    return tuple(sections)


def _section(section: SectionInput, length: float) -> BeamSection:
    """Return a piece of the `length` (m)."""
    return BeamSection(
        length,
        section.outer_diameter_mm * MM,
        section.bore_diameter_mm * MM,
        section.youngs_modulus_gpa * GPA,
        section.poissons_ratio,
        section.density_kg_per_m3,
    )


def has_bent_shafts(database: SteDatabase) -> bool:
    """Return whether a table has the bending of its gears' shafts in it."""
    ledger = database.metadata.effect_ledger
    entries = ledger if isinstance(ledger, list) else ledger.get("entries", [])
    return any(
        isinstance(e, Mapping) and e.get("name") == "shaft_deflection" and e.get("on") for e in entries
    )
