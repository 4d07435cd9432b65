"""Values of a component in SI, by the quantity that REXS gives each attribute."""

from __future__ import annotations

import functools
import tomllib
from importlib.resources import files

from lineofaction.gearbox.rexs.model import Attribute, Component
from lineofaction.gearbox.rexs.refusal import refused
from lineofaction.gearbox.rexs.upgrade import si_value


def quantity(component: Component, name: str, place: str) -> float | None:
    """Return a number of a component in SI, None where the file gives none.

    Parameters
    ----------
    component : Component
        Of a model of the newest version.
    name : str
        An attribute of `quantities.toml`.
    place : str
        The component, for the error.

    Raises
    ------
    BadInput
        The value is no number, is given twice, or its unit belongs to another quantity.
    """
    attribute = _only(component, name, place)
    if attribute is None or attribute.value is None:
        return None
    return _number(attribute.value, attribute, f"{place}, {name}")


def quantities(component: Component, name: str, place: str) -> tuple[float, ...] | None:
    """Return an array of numbers of a component in SI, as `quantity` a number.

    Raises
    ------
    BadInput
        The value is no array of numbers, is given twice, or its unit belongs to another quantity.
    """
    attribute = _only(component, name, place)
    if attribute is None or attribute.value is None:
        return None
    if not isinstance(attribute.value, tuple):
        raise refused(f"{place}, {name}", attribute.value, "an array of numbers")
    return tuple(_number(entry, attribute, f"{place}, {name}") for entry in attribute.value)


def listed_unit(name: str) -> str | None:
    """Return the unit that REXS gives an attribute, None of one that is not in `quantities.toml`."""
    return _units().get(name)


def _only(component: Component, name: str, place: str) -> Attribute | None:
    """Return the attribute of a name, None if there is none."""
    named = [attribute for attribute in component.attributes if attribute.id == name]
    if len(named) > 1:
        raise refused(f"{place}, {name}", f"{len(named)} values", "given once")
    return named[0] if named else None


def _number(value: object, attribute: Attribute, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise refused(place, value, "a number")
    return si_value(float(value), attribute.unit, _units()[attribute.id], place)


@functools.cache
def _units() -> dict[str, str]:
    """Return the unit of each attribute of the table."""
    table = tomllib.loads(files(__package__).joinpath("quantities.toml").read_text(encoding="utf-8"))
    return {name: unit for unit, names in table.items() for name in names}
