"""Stages of a REXS model: two gears in mesh, the shafts that carry them, and their ratio."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part

_GEARS = ("gear_1", "gear_2")
NO_STAGE = "relation `stage` needs two gears with teeth, on two shafts that carry them and turn by themselves"


@dataclass(frozen=True)
class GearStage:
    """Two gears in mesh.

    Attributes
    ----------
    stage : Part
        The stage.
    gears, shafts : (Part, Part)
        Gear 1 and gear 2 of the file, and what carries them.
    teeth : (int, int)
        Their numbers of teeth, positive.
    internal : bool
        One of them is a ring gear.
    """

    stage: Part
    gears: tuple[Part, Part]
    shafts: tuple[Part, Part]
    teeth: tuple[int, int]
    internal: bool

    @property
    def is_cylindrical(self) -> bool:
        """Whether it is a stage of parallel axes, which is computed."""
        return self.stage.type == "cylindrical_stage"


def gear_stages(unit: GearUnit) -> tuple[GearStage, ...]:
    """Return the stages of the model, in the order of their relations."""
    return tuple(_stages(unit))


def _stages(unit: GearUnit) -> Iterator[GearStage]:
    """Yield the stages whose gears, teeth and shafts the file states."""
    for relation in unit.relations("stage"):
        number = relation.of_role("stage")
        ends = [relation.of_role(role) for role in _GEARS]
        if number is None:
            continue
        stage = unit.part(number)
        gears = [unit.part(end) for end in ends if end is not None]
        shafts = [owner for gear in gears if (owner := unit.owner(gear, "shaft")) is not None]
        signed = [teeth for gear in gears if (teeth := teeth_of(gear)) is not None]
        if len(gears) != 2 or len(shafts) != 2 or len(signed) != 2 or shafts[0].id == shafts[1].id:
            stage.say("", "refused", NO_STAGE)
            continue
        internal = any(gear.type == "ring_gear" for gear in gears)
        first, second = (abs(teeth) for teeth in signed)
        yield GearStage(stage, (gears[0], gears[1]), (shafts[0], shafts[1]), (first, second), internal)


def teeth_of(gear: Part) -> int | None:
    """Return the number of teeth, negative of some ring gears, None where the file gives none."""
    attribute = gear.attribute("number_of_teeth")
    value = None if attribute is None else attribute.value
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value == 0 or value != value // 1:
        return None
    return int(value)
