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


def shaft_of(index: int, given: ShaftInput) -> Shaft:
    """Return a shaft; a diameter is one section of steel, an inertia alone is rigid."""
    x, y, z = given.origin_mm
    sections = _sections(index, given)
    with named(f"shafts[{index}]"):
        return Shaft(
            given.name,
            given.length_mm * MM,
            (x * MM, y * MM, z * MM),
            _inertia(given.inertia),
            given.frame,
            sections,
            given.damping_ratio,
        )


def _inertia(given: InertiaInput | None) -> Inertia:
    """Return the inertia of a rigid shaft."""
    return Inertia() if given is None else Inertia(given.mass_kg, given.polar_kg_m2, given.transverse_kg_m2)


def _sections(index: int, given: ShaftInput) -> tuple[BeamSection, ...]:
    """Return the pieces; their lengths, which agree with the shaft's, to the last digit."""
    if given.diameter_mm is not None:
        return (BeamSection(given.length_mm * MM, given.diameter_mm * MM),)
    parts = given.sections or ()
    together = sum(part.length_mm for part in parts)
    found = []
    for place, part in enumerate(parts):
        with named(f"shafts[{index}].sections[{place}]"):
            found.append(_section(part, part.length_mm * (given.length_mm / together) * MM))
    return tuple(found)


def _section(given: SectionInput, length: float) -> BeamSection:
    """Return a piece of the `length` (m)."""
    return BeamSection(
        length,
        given.outer_diameter_mm * MM,
        given.bore_diameter_mm * MM,
        given.youngs_modulus_gpa * GPA,
        given.poissons_ratio,
        given.density_kg_per_m3,
    )


def has_bent_shafts(database: SteDatabase) -> bool:
    """Return whether a table has the bending of its gears' shafts in it."""
    ledger = database.metadata.effect_ledger
    entries = ledger if isinstance(ledger, list) else ledger.get("entries", [])
    return any(
        isinstance(e, Mapping) and e.get("name") == "shaft_deflection" and e.get("on") for e in entries
    )
