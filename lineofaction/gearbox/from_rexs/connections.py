"""What joins two components: couplings and bearings with an inner and an outer side."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part

BEARINGS = (
    "concept_bearing",
    "rolling_bearing_with_catalog_geometry",
    "rolling_bearing_with_detailed_geometry",
)
COUPLINGS = ("coupling", "switchable_coupling")
GROUND = ("gear_casing", "assembly_group", "gear_unit")


@dataclass(frozen=True)
class Connection:
    """A bearing or a coupling, and the components on its sides.

    Attributes
    ----------
    part : Part
        The bearing or coupling.
    inner, outer : Part
        The components it joins.
    """

    part: Part
    inner: Part
    outer: Part

    @property
    def on_ground(self) -> Part | None:
        """The side that the ground holds, None if both can turn."""
        return next((side for side in (self.inner, self.outer) if side.type in GROUND), None)

    @property
    def held(self) -> Part:
        """The side that turns; the inner one if both do."""
        return self.outer if self.inner.type in GROUND else self.inner

    def other(self, side: Part) -> Part:
        """Return the side opposite of one."""
        return self.outer if side.id == self.inner.id else self.inner


def bearings(unit: GearUnit) -> tuple[Connection, ...]:
    """Return the bearings, in the order of the file."""
    return tuple(_connections(unit, BEARINGS))


def couplings(unit: GearUnit) -> tuple[Connection, ...]:
    """Return the couplings that are engaged, in the order of the file."""
    return tuple(entry for entry in _connections(unit, COUPLINGS) if _engaged(unit, entry.part))


def _connections(unit: GearUnit, types: tuple[str, ...]) -> Iterator[Connection]:
    """Yield components of these types that have both sides."""
    for part in unit.of_type(*types):
        inner = unit.related(part, "side", "assembly", "inner_part")
        outer = unit.related(part, "side", "assembly", "outer_part")
        if inner and outer and inner[0].id != outer[0].id:
            yield Connection(part, inner[0], outer[0])
        else:
            part.say("", "refused", "no relation `side` says what its inner and outer side hold")


def _engaged(unit: GearUnit, part: Part) -> bool:
    attribute = part.attribute("is_engaged")
    if attribute is None or attribute.value is None:
        return True
    values = attribute.value if isinstance(attribute.value, tuple) else (attribute.value,)
    index = _shift_index(unit)
    if not 0 <= index < len(values):
        part.say("is_engaged", "refused", f"no value for gear {index + 1}; taken as engaged")
        return True
    part.say("is_engaged", "taken", f"in gear {index + 1}")
    if not values[index]:
        part.say("", "ignored", f"not engaged in gear {index + 1}")
    return bool(values[index])


def _shift_index(unit: GearUnit) -> int:
    """Return which of its gears the unit runs in, counted from 0."""
    for part in unit.of_type("gear_unit"):
        attribute = part.attribute("gear_shift_index")
        if attribute is not None and isinstance(attribute.value, int) and attribute.value > 0:
            part.say("gear_shift_index", "taken", "gear that is engaged")
            return attribute.value - 1
    return 0
