"""Words, units and quantities of REXS, from the tables in this folder."""

from __future__ import annotations

import functools
import tomllib
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, Literal

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Component


@functools.cache
def table(name: str) -> dict[str, Any]:
    """Return a TOML table of this package."""
    return tomllib.loads(files(__package__).joinpath(f"{name}.toml").read_text(encoding="utf-8"))


@functools.cache
def owners(name: str) -> dict[str, str]:
    """Return the key by entry, of a table that has a list of entries for each key."""
    return {entry: key for key, entries in table(name).items() for entry in entries}


def terms(name: Literal["descriptive_components", "bearing_types"]) -> frozenset[str]:
    """Return the words for a type of component."""
    return frozenset(table("vocabulary")[name])


@dataclass(frozen=True)
class _SiUnit:
    """A unit: a value v in it is v * factor + offset in the SI unit `si`."""

    si: str
    factor: float = 1.0
    offset: float = 0.0


@functools.cache
def units() -> dict[str, _SiUnit]:
    """Return every unit of REXS 1.0 to 2.0.0 by its spelling."""
    return {name: _SiUnit(**unit) for name, unit in table("units").items()}


def si_value(value: float, unit: str | None, expected: str, location: str) -> float:
    """Return a value in SI.

    Raises `BadInput`: the unit is none of REXS, or of another quantity.

    Parameters
    ----------
    value, unit : float, str or None
        Value and unit as the file has them.
    expected : str
        A unit of the value's quantity, as the schema has it.
    location : str
        Component and attribute, for the error.
    """
    written = units().get("none" if unit is None else unit)
    expected_unit = units()[expected]
    if written is None or written.si != expected_unit.si:
        fit = ", ".join(
            name for name, unit_row in units().items() if unit_row.si == expected_unit.si and name
        )
        raise BadInput.of(f"{location}, unit", unit, f"one of {fit}")
    return value * written.factor + written.offset


def listed_unit(name: str) -> str | None:
    """Return the unit that REXS gives an attribute, None of one that is not in `quantities.toml`."""
    return owners("quantities").get(name)


def quantity(component: Component, name: str, location: str) -> float | None:
    """Return a number of a component in SI, None where the file gives none.

    Raises `BadInput`: the value is no number, is given twice, or its unit belongs to another quantity.

    Parameters
    ----------
    component : Component
        Component of a model in the newest version.
    name : str
        An attribute of `quantities.toml`.
    location : str
        The component, for the error.
    """
    attribute = _sole_attribute(component, name, location)
    return None if attribute is None else _number(attribute.value, attribute, f"{location}, {name}")


def quantities(component: Component, name: str, location: str) -> tuple[float, ...] | None:
    """Return an array of numbers of a component in SI, as `quantity` a number."""
    attribute = _sole_attribute(component, name, location)
    if attribute is None:
        return None
    if not isinstance(attribute.value, tuple):
        raise BadInput.of(f"{location}, {name}", attribute.value, "an array of numbers")
    return tuple(_number(entry, attribute, f"{location}, {name}") for entry in attribute.value)


def _sole_attribute(component: Component, name: str, location: str) -> Attribute | None:
    """Return the attribute of a name, None if there is none or it has no value."""
    named = [attribute for attribute in component.attributes if attribute.id == name]
    if len(named) > 1:
        raise BadInput.of(f"{location}, {name}", f"{len(named)} values", "given once")
    return named[0] if named and named[0].value is not None else None


def _number(value: object, attribute: Attribute, location: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise BadInput.of(location, value, "a number")
    return si_value(float(value), attribute.unit, owners("quantities")[attribute.id], location)
