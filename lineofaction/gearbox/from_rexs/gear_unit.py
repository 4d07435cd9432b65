"""The parts of a gear unit as a REXS model states them: attributes, relations, stages, planetary sets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import overload

from bounds import Bound, Declared
from lineofaction.gearbox.from_rexs.account import Account, Fate
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Component, Model, Relation, Value
from lineofaction.gearbox.rexs.vocabulary import quantities, quantity

BEARINGS = (
    "concept_bearing",
    "rolling_bearing_with_catalog_geometry",
    "rolling_bearing_with_detailed_geometry",
)
COUPLINGS = ("coupling", "switchable_coupling")
GROUND = ("gear_casing", "assembly_group", "gear_unit")

NO_STAGE = "relation `stage` needs two gears with teeth, on two shafts that carry them and turn by themselves"


class Part:
    """A component as an import reads it, with its account and the parts that it is related to.

    Whoever reads a value gives its meaning, and the account gets the value as taken. `say` corrects that
    entry: derived, defaulted, ignored or refused. Numbers are in SI; None stands for what the file does not
    give. Reading raises `BadInput` where a value is no number, is given twice, or has a unit of another
    quantity.
    """

    def __init__(self, component: Component, unit: GearUnit) -> None:
        self.component = component
        self.unit = unit

    @property
    def id(self) -> int:
        """Id of the component."""
        return self.component.id

    @property
    def type(self) -> str:
        """Type of the component."""
        return self.component.type

    @property
    def location(self) -> str:
        """The place of the component in the file."""
        return self.unit.account.location(self.component)

    @property
    def name(self) -> str:
        """Name in the file, or type and id."""
        return self.component.name or f"{self.type} {self.id}"

    @overload
    def number(self, item: str, meaning: str) -> float | None: ...

    @overload
    def number(self, item: str, meaning: str, default: float, why: str = "") -> float: ...

    def number(self, item: str, meaning: str, default: float | None = None, why: str = "") -> float | None:
        """Return a number; the default, which the account states with its reason, where the file has none."""
        value = quantity(self.component, item, self.location)
        if value is not None:
            self.say(item, "taken", meaning)
        elif why:
            self.say(item, "defaulted", why)
        return default if value is None else value

    def refusal(self, item: str, value: object, bound: str, remedy: str = "") -> BadInput:
        """Return the error of an attribute's value, in the unit of REXS."""
        return BadInput.of(f"{self.location}, {item}", value, bound, remedy)

    def required(self, item: str, meaning: str) -> float:
        """Return a number that the component must have."""
        value = self.number(item, meaning)
        if value is None:
            raise self.refusal(item, None, "given", f"{self.name} needs it.")
        return value

    def positive(self, item: str, meaning: str) -> float:
        """Return a number above zero that the component must have."""
        value = self.required(item, meaning)
        if not value > 0.0:
            raise self.refusal(item, value, "above 0")
        return value

    def bounded(self, item: str, meaning: str, field: Declared) -> float | None:
        """Return a number; None, and refused, where it is out of the bounds of a field of the scene."""
        value, attribute, limits = self.number(item, meaning), self.attribute(item), field.limits
        if value is None or attribute is None or not isinstance(limits, Bound) or limits.holds(value):
            return value
        self.say(item, "refused", f"{attribute.value} {attribute.unit} is not {limits} {field.unit}")
        return None

    def numbers(self, item: str, meaning: str) -> tuple[float, ...] | None:
        """Return an array of numbers."""
        values = quantities(self.component, item, self.location)
        if values is not None:
            self.say(item, "taken", meaning)
        return values

    def vector(self, item: str, meaning: str) -> tuple[float, ...] | None:
        """Return an array of numbers, None also where the file gives no array.

        One writer's JSON has ``false`` in place of vectors: such a value is refused in the account.
        """
        value = self.value(item)
        if value is not None and not isinstance(value, tuple):
            self.say(item, "refused", f"{value} is no vector")
            return None
        return self.numbers(item, meaning)

    def text(self, item: str, meaning: str) -> str | None:
        """Return a word or a name."""
        value = self.value(item)
        if value is None:
            return None
        self.say(item, "taken", meaning)
        return str(value)

    def attribute(self, item: str) -> Attribute | None:
        """Return an attribute as it stands, without an entry in the account."""
        return self.component.attribute(item)

    def value(self, item: str) -> Value:
        """Return the value of an attribute as it stands, without an entry in the account."""
        attribute = self.attribute(item)
        return None if attribute is None else attribute.value

    def say(self, item: str, fate: Fate, text: str) -> None:
        """State the fate of an attribute that the component has or lacks; "" is the component."""
        self.unit.account.say(self.component, item, fate, text)

    def related(self, relation: str, role: str, other: str) -> tuple[Part, ...]:
        """Return the components in role `other` of the relations in which this one has `role`.

        Relations with an order come in it, others in the order of the file.
        """
        entries = [entry for entry in self.unit.relations(relation) if entry.of_role(role) == self.id]
        entries.sort(key=lambda entry: entry.order or 0)
        return tuple(self.unit.part(ref.id) for entry in entries for ref in entry.refs if ref.role == other)

    @property
    def referenced(self) -> tuple[Part, ...]:
        """The components that this one refers to."""
        return self.related("reference", "origin", "referenced")

    def children(self, *types: str) -> tuple[Part, ...]:
        """Return the parts of an assembly, an ordered one's in its order; all types if none is named."""
        parts = (
            *self.related("ordered_assembly", "assembly", "part"),
            *self.related("assembly", "assembly", "part"),
        )
        unique = {child.id: child for child in parts}
        return tuple(child for child in unique.values() if not types or child.type in types)

    @property
    def shaft(self) -> Part | None:
        """The first shaft that has the component, None if there is none."""
        for relation in self.unit.relations("assembly", "ordered_assembly"):
            owner = relation.of_role("assembly")
            if relation.of_role("part") == self.id and owner is not None:
                part = self.unit.part(owner)
                if part.type == "shaft":
                    return part
        return None

    @property
    def teeth(self) -> int | None:
        """Number of teeth, negative of some ring gears."""
        value = self.value("number_of_teeth")
        if isinstance(value, bool) or not isinstance(value, (int, float)) or value == 0 or value % 1:
            return None
        return int(value)


class GearUnit:
    """A model's components, by type and by their roles in relations.

    Parameters
    ----------
    model : Model
        Model in the newest version, with checked references.

    Attributes
    ----------
    account : Account
        Fates of the model's values.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.account = Account(model)
        self._parts = {component.id: Part(component, self) for component in model.components}

    def part(self, number: int) -> Part:
        """Return the component of an id."""
        return self._parts[number]

    def of_type(self, *types: str) -> tuple[Part, ...]:
        """Return the components of these types, in the order of the file."""
        return tuple(part for part in self._parts.values() if part.type in types)

    def relations(self, *types: str) -> Iterator[Relation]:
        """Yield the relations of these types, in the order of the file."""
        return (relation for relation in self.model.relations if relation.type in types)

    def load_cases(self) -> tuple[tuple[Part, ...], ...]:
        """Return the components of each load case of the first spectrum, empty without a spectrum."""
        cases = self.model.spectra[0].cases if self.model.spectra else ()
        return tuple(tuple(Part(part, self) for part in case.components) for case in cases)

    @cached_property
    def bearings(self) -> tuple[Connection, ...]:
        """The bearings, in the order of the file."""
        return tuple(_connections(self, BEARINGS))

    @cached_property
    def couplings(self) -> tuple[Connection, ...]:
        """The couplings that are engaged, in the order of the file."""
        return tuple(entry for entry in _connections(self, COUPLINGS) if _engaged(entry.part))

    @cached_property
    def stages(self) -> tuple[GearStage, ...]:
        """The stages whose gears, teeth and shafts the file states, in the order of their relations."""
        return tuple(_gear_stages(self))

    @cached_property
    def planetary_sets(self) -> tuple[PlanetarySet, ...]:
        """The planetary sets with a carrier and planets; the account names missing parts of others."""
        return tuple(_planetary_sets(self))

    def say(self, item: str, fate: Fate, text: str) -> None:
        """State something of the whole unit."""
        for part in self.of_type("gear_unit")[:1]:
            part.say(item, fate, text)


def rounded(value: float) -> float:
    """Return a number without the rounding that its computation or a change of units leaves: 12 digits."""
    return float(f"{value:.12g}") + 0.0


@dataclass(frozen=True)
class Connection:
    """A bearing or a coupling, and the components that it joins, on its inner and its outer side."""

    part: Part
    inner: Part
    outer: Part

    @property
    def on_ground(self) -> Part | None:
        """The side that the ground holds, None if both can turn."""
        return next((side for side in (self.inner, self.outer) if side.type in GROUND), None)

    @property
    def rotor_side(self) -> Part:
        """The side that turns; the inner one if both do."""
        return self.outer if self.inner.type in GROUND else self.inner

    def other(self, side: Part) -> Part:
        """Return the side opposite of one."""
        return self.outer if side.id == self.inner.id else self.inner


def _connections(unit: GearUnit, types: tuple[str, ...]) -> Iterator[Connection]:
    for part in unit.of_type(*types):
        inner = part.related("side", "assembly", "inner_part")
        outer = part.related("side", "assembly", "outer_part")
        if inner and outer and inner[0].id != outer[0].id:
            yield Connection(part, inner[0], outer[0])
        else:
            part.say("", "refused", "no relation `side` says what its inner and outer side hold")


def _engaged(part: Part) -> bool:
    engaged = part.value("is_engaged")
    if engaged is None:
        return True
    values = engaged if isinstance(engaged, tuple) else (engaged,)
    index = _shift_index(part.unit)
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
        value = part.value("gear_shift_index")
        if isinstance(value, int) and value > 0:
            part.say("gear_shift_index", "taken", "gear that is engaged")
            return value - 1
    return 0


@dataclass(frozen=True)
class GearStage:
    """Two gears in mesh."""

    stage: Part
    gears: tuple[Part, Part]
    shafts: tuple[Part, Part]
    """`gears`, `shafts`: Gear 1 and gear 2 of the file, and the shaft or carrier of each. Shape (Part, Part)
    each."""
    teeth: tuple[int, int]
    """Numbers of teeth of both gears, positive."""
    internal: bool
    """Whether one of the gears is a ring gear."""

    @property
    def is_cylindrical(self) -> bool:
        """Whether it is a stage of parallel axes, which is computed."""
        return self.stage.type == "cylindrical_stage"


def _gear_stages(unit: GearUnit) -> Iterator[GearStage]:
    for relation in unit.relations("stage"):
        number = relation.of_role("stage")
        if number is None:
            continue
        stage = unit.part(number)
        ends = [relation.of_role(role) for role in ("gear_1", "gear_2")]
        gears = [unit.part(end) for end in ends if end is not None]
        shafts = [shaft for gear in gears if (shaft := gear.shaft) is not None]
        signed = [teeth for gear in gears if (teeth := gear.teeth) is not None]
        if len(gears) != 2 or len(shafts) != 2 or len(signed) != 2 or shafts[0].id == shafts[1].id:
            stage.say("", "refused", NO_STAGE)
            continue
        internal = any(gear.type == "ring_gear" for gear in gears)
        first, second = (abs(teeth) for teeth in signed)
        yield GearStage(stage, (gears[0], gears[1]), (shafts[0], shafts[1]), (first, second), internal)


@dataclass(frozen=True)
class PlanetarySet:
    """A planetary stage."""

    stage: Part
    """The component `planetary_stage`."""
    planets: tuple[Part, ...]
    """The shafts of its planets."""
    central: tuple[Part, ...]
    """The shafts of sun and ring gear."""
    carrier: tuple[Part, ...]
    """All that turns as its carrier: shafts, pins, side plates."""

    @property
    def pins(self) -> tuple[Part, ...]:
        """The shafts of the carrier on which planets turn."""
        return self.stage.related("planet_pin", "planetary_stage", "shaft")


def _planetary_sets(unit: GearUnit) -> Iterator[PlanetarySet]:
    for stage in unit.of_type("planetary_stage"):
        planets, central, carrier, pins = (
            stage.related(relation, "planetary_stage", "shaft")
            for relation in ("planet_shaft", "central_shaft", "planet_carrier_shaft", "planet_pin")
        )
        carriers = stage.children("planet_carrier")
        plates = (part for carrier_part in carriers for part in carrier_part.children("shaft", "side_plate"))
        turning = {part.id: part for part in (*carrier, *pins, *plates)}
        planetary = PlanetarySet(stage, planets, central, tuple(turning.values()))
        if planetary.planets and planetary.carrier:
            stage.say("", "taken", f"planetary set of {len(planetary.planets)} planets")
            yield planetary
        else:
            stage.say("", "refused", "relations `planet_shaft` and `planet_carrier_shaft` are needed")
