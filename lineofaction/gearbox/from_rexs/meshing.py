"""Senses of rotation and hands of two gears in mesh, and which gear drives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit, Part
from lineofaction.gearbox.from_rexs.placement import frame_of

STAGES = ("cylindrical_stage",)
OTHER_STAGES = ("bevel_stage", "worm_stage", "hypoid_stage", "beveloid_stage")
_DATA = ("cylindrical_stage_gear_data", "stage_gear_data")


class _Sense(NamedTuple):
    """Sense of a gear or shaft about its u axis, 1 or -1, and the shaft whose speed determines it."""

    sense: float
    shaft: str


@dataclass(frozen=True)
class Meshing:
    """Two gears of a stage."""

    stage: Part
    pinion: Part
    wheel: Part
    """`stage`, `pinion`, `wheel`: The stage; gear 1 and gear 2 of the case: the driver and the driven gear, a
    ring gear always gear 2.
    """
    wheel_drives: bool
    """Whether the ring gear drives."""
    z: FloatArray
    """The case's axis in the frame of the unit: seen from +z, the torque of the shaft on the pinion acts
    clockwise and right flanks carry. Array (3,).
    """

    @classmethod
    def of(cls, stage: Part, driver: int | None = None, torques: tuple[float, ...] = ()) -> Meshing:
        """Return the meshing gears of a stage.

        Parameters
        ----------
        driver : int, optional
            Id of the driving gear; else the file's `is_driving_gear`, else gear 1.
        torques : tuple of float, optional
            Torques on the driving gear about its u axis, N m; their sign is the gear's sense of rotation.
        """
        gears = _stage_gears(stage)
        if gears is None or all(gear.type == "ring_gear" for gear in gears):
            raise stage.refusal("stage", None, "a relation to two gears, one of them external")
        driving = _driver(stage, gears, driver)
        sense = _sense(stage, driving, torques)
        ring = next((gear for gear in gears if gear.type == "ring_gear"), None)
        pinion = driving if ring is None else _other(gears, ring)
        wheel_drives = driving is ring
        # The driver turns with the torque of its shaft, the pinion of a driving ring gear against it.
        z = sense * frame_of(driving).u * (1.0 if wheel_drives else -1.0)
        return cls(stage, pinion, _other(gears, pinion), wheel_drives, z)

    @property
    def internal(self) -> bool:
        """Whether the wheel is a ring gear."""
        return self.wheel.type == "ring_gear"

    @property
    def driver(self) -> Part:
        """The driving gear."""
        return self.wheel if self.wheel_drives else self.pinion

    @property
    def driven(self) -> Part:
        """The driven gear."""
        return self.pinion if self.wheel_drives else self.wheel


def _stage_gears(stage: Part) -> tuple[Part, Part] | None:
    """Return gear 1 and gear 2 of a stage, None if the file does not relate them."""
    for relation in stage.unit.relations("stage"):
        first, second = relation.of_role("gear_1"), relation.of_role("gear_2")
        if relation.of_role("stage") == stage.id and first is not None and second is not None:
            return stage.unit.part(first), stage.unit.part(second)
    return None


def _senses(unit: GearUnit) -> dict[int, _Sense]:
    """Return the senses by component that follow from given speeds, shaft by shaft and stage by stage.

    Mating external gears turn in opposite senses, a ring gear as its mate. In a planetary stage these are
    the senses relative to the carrier, if the sun turns faster than it.
    """
    shafts = unit.of_type("shaft")
    known = {shaft.id: _Sense(sense, shaft.name) for shaft in shafts if (sense := _sense_of_speed(shaft))}
    gears = unit.of_type("cylindrical_gear", "ring_gear")
    # two components, and the sense of the second over that of the first
    links = [(shaft, gear, _aligned(shaft, gear)) for gear in gears if (shaft := gear.shaft) is not None]
    for stage in unit.of_type(*STAGES):
        if (pair := _stage_gears(stage)) is not None:
            has_ring = "ring_gear" in (pair[0].type, pair[1].type)
            links.append((*pair, _aligned(*pair) * (1.0 if has_ring else -1.0)))
    while True:
        count = len(known)
        for first, second, ratio in links:
            for source, target in ((first, second), (second, first)):
                if source.id in known and target.id not in known:
                    known[target.id] = _Sense(ratio * known[source.id].sense, known[source.id].shaft)
        if len(known) == count:
            return known


def _sense_of_speed(shaft: Part) -> float | None:
    """Return the sign of a shaft's stated speed, else of its speed in a load case; None: no speed."""
    cases = shaft.unit.load_cases()
    for part in (shaft, *(part for case in cases for part in case if part.id == shaft.id)):
        speed = part.number("rotational_speed", "sense in which the gears turn")
        if speed:
            return math.copysign(1.0, speed)
    return None


def _aligned(first: Part, second: Part) -> float:
    """Return 1 if two u axes point the same way, else -1."""
    return math.copysign(1.0, float(np.dot(frame_of(first).u, frame_of(second).u)))


def _other(gears: tuple[Part, Part], gear: Part) -> Part:
    return gears[1] if gear is gears[0] else gears[0]


def _driver(stage: Part, gears: tuple[Part, Part], driver: int | None) -> Part:
    if driver is not None:
        chosen = next((gear for gear in gears if gear.id == driver), None)
        if chosen is None:
            raise stage.refusal("driver", driver, f"one of {[gear.id for gear in gears]}")
        return chosen
    marked = [gear for gear in gears if _is_marked(stage, gear)]
    if len(marked) == 1:
        return marked[0]
    stage.say("driving_gear", "defaulted", f"gear_1, {gears[0].name}: the file marks no driving gear")
    return gears[0]


def _is_marked(stage: Part, gear: Part) -> bool:
    for relation in stage.unit.relations("stage_gear_data"):
        if relation.of_role("stage") == stage.id and relation.of_role("gear") == gear.id:
            number = relation.of_role("stage_gear_data")
            data = None if number is None else stage.unit.part(number)
            if data is not None and data.type in _DATA:
                return data.text("is_driving_gear", "the driver of the case") == "True"
    return False


def _sense(stage: Part, driver: Part, torques: tuple[float, ...]) -> float:
    """Return the sense in which the driver turns about its u axis: by its torque, else by the speeds."""
    signs = {math.copysign(1.0, torque) for torque in torques if torque}
    if len(signs) > 1:
        raise stage.refusal("torque", list(torques), "of one sign", "Make a case for each sense of rotation.")
    if signs:
        return signs.pop()
    if (known := _senses(stage.unit).get(driver.id)) is not None:
        stage.say("sense_of_rotation", "derived", f"from the speed of {known.shaft}")
        return known.sense
    stage.say("sense_of_rotation", "defaulted", f"{driver.name} turns about +u: the file gives no speed")
    return 1.0
