"""Planetary sets of a REXS model: carrier, planets, central shafts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part


@dataclass(frozen=True)
class PlanetarySet:
    """A planetary stage.

    Attributes
    ----------
    stage : Part
        The component `planetary_stage`.
    planets : tuple of Part
        The shafts of its planets.
    central : tuple of Part
        The shafts of sun and ring gear.
    carrier : tuple of Part
        All that turns as its carrier: shafts, pins, side plates.
    """

    stage: Part
    planets: tuple[Part, ...]
    central: tuple[Part, ...]
    carrier: tuple[Part, ...]


def planetary_sets(unit: GearUnit) -> tuple[PlanetarySet, ...]:
    """Return the planetary sets that have a carrier and planets; the account says what the others lack."""
    sets = []
    for stage in unit.of_type("planetary_stage"):
        planetary = PlanetarySet(
            stage,
            unit.related(stage, "planet_shaft", "planetary_stage", "shaft"),
            unit.related(stage, "central_shaft", "planetary_stage", "shaft"),
            _unique(_carrier(unit, stage)),
        )
        if planetary.planets and planetary.carrier:
            sets.append(planetary)
            stage.say("", "taken", f"planetary set of {len(planetary.planets)} planets")
        else:
            stage.say("", "refused", "relations `planet_shaft` and `planet_carrier_shaft` are needed")
    return tuple(sets)


def _carrier(unit: GearUnit, stage: Part) -> Iterable[Part]:
    """Yield the parts that the file calls the carrier's, pins included."""
    for relation in ("planet_carrier_shaft", "planet_pin"):
        yield from unit.related(stage, relation, "planetary_stage", "shaft")
    for carrier in unit.children(stage, "planet_carrier"):
        yield from unit.children(carrier, "shaft", "side_plate")


def _unique(parts: Iterable[Part]) -> tuple[Part, ...]:
    return tuple({part.id: part for part in parts}.values())
