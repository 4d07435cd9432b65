"""In which sense the gears of a unit turn, from the speeds of shafts that the file gives."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.placement import frame_of


@dataclass(frozen=True)
class Rotation:
    """Sense of a gear or shaft about its own u axis, 1 or -1, and the shaft whose speed it follows from."""

    sense: float
    source: str


def stage_gears(unit: GearUnit, stage: Part) -> tuple[Part, Part] | None:
    """Return gear 1 and gear 2 of a stage, None if the file does not relate them."""
    for relation in unit.relations("stage"):
        first, second = relation.of_role("gear_1"), relation.of_role("gear_2")
        if relation.of_role("stage") == stage.id and first is not None and second is not None:
            return unit.part(first), unit.part(second)
    return None


def rotations(unit: GearUnit) -> dict[int, Rotation]:
    """Return the rotations by component that follow from given speeds, shaft by shaft and stage by stage.

    Mating external gears turn in opposite senses, a ring gear as its mate. In a planetary stage these are
    the senses relative to the carrier, if the sun turns faster than it.
    """
    known = {
        shaft.id: Rotation(speed, shaft.name)
        for shaft in unit.of_type("shaft")
        if (speed := _speed(unit, shaft))
    }
    links = [*_on_shafts(unit), *_in_mesh(unit)]
    while True:
        count = len(known)
        for first, second, ratio in links:
            _pass_on(known, first, second, ratio)
            _pass_on(known, second, first, ratio)
        if len(known) == count:
            return known


def _pass_on(known: dict[int, Rotation], source: Part, target: Part, ratio: float) -> None:
    """Enter the rotation of a component that turns with another."""
    if source.id in known and target.id not in known:
        rotation = known[source.id]
        known[target.id] = Rotation(ratio * rotation.sense, rotation.source)


def _speed(unit: GearUnit, shaft: Part) -> float | None:
    """Return the sign of a shaft's speed: its own, else that of a load case; None without one."""
    parts = (shaft, *(part for case in unit.load_cases() for part in case if part.id == shaft.id))
    for part in parts:
        speed = part.number("rotational_speed", "sense in which the gears turn")
        if speed:
            return math.copysign(1.0, speed)
    return None


def _on_shafts(unit: GearUnit) -> list[tuple[Part, Part, float]]:
    """Return shafts and their gears, -1 where a gear's u axis is against the shaft's."""
    gears = unit.of_type("cylindrical_gear", "ring_gear")
    pairs = [(unit.owner(gear, "shaft"), gear) for gear in gears]
    return [(shaft, gear, _aligned(unit, shaft, gear)) for shaft, gear in pairs if shaft is not None]


def _in_mesh(unit: GearUnit) -> list[tuple[Part, Part, float]]:
    """Return mating gears with the ratio of their senses."""
    links = []
    for stage in unit.of_type("cylindrical_stage"):
        gears = stage_gears(unit, stage)
        if gears is not None:
            same = "ring_gear" in (gears[0].type, gears[1].type)
            links.append((*gears, _aligned(unit, *gears) * (1.0 if same else -1.0)))
    return links


def _aligned(unit: GearUnit, first: Part, second: Part) -> float:
    """Return 1 if two u axes point the same way, else -1."""
    return math.copysign(1.0, float(np.dot(frame_of(unit, first).u, frame_of(unit, second).u)))
