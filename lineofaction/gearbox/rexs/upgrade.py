"""Upgrades of REXS: what a version renamed is renamed, what it removed is kept and reported."""

from __future__ import annotations

import functools
import math
import tomllib
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import Any

from lineofaction.gearbox.rexs.model import Attribute, Component, Model, Value
from lineofaction.gearbox.rexs.refusal import refused

# The units of REXS in SI.


@dataclass(frozen=True)
class SiUnit:
    """A unit: a value v in it is v * factor + offset in the SI unit `si`."""

    si: str
    factor: float = 1.0
    offset: float = 0.0


_TURN = 2.0 * math.pi
_DEGREE = SiUnit("rad", math.pi / 180.0)
_NONE = SiUnit("")

UNITS: dict[str, SiUnit] = {
    "none": _NONE,
    "": _NONE,
    "%": SiUnit("", 1e-2),
    "dB": SiUnit("dB"),
    "HB": SiUnit("HB"),
    "HRC": SiUnit("HRC"),
    "HV": SiUnit("HV"),
    "MRev": SiUnit("rad", 1e6 * _TURN),
    # lengths, angles, time
    "mm": SiUnit("m", 1e-3),
    "mum": SiUnit("m", 1e-6),
    "1 / mm": SiUnit("1/m", 1e3),
    "mm^2": SiUnit("m^2", 1e-6),
    "m^2": SiUnit("m^2"),
    "deg": _DEGREE,
    "°": _DEGREE,
    "rad": SiUnit("rad"),
    "s": SiUnit("s"),
    "mus": SiUnit("s", 1e-6),
    "h": SiUnit("s", 3600.0),
    "Hz": SiUnit("1/s"),
    "1 / s": SiUnit("1/s"),
    "1 / min": SiUnit("rad/s", _TURN / 60.0),
    "rad / s": SiUnit("rad/s"),
    "m / s": SiUnit("m/s"),
    "mm / h": SiUnit("m/s", 1e-3 / 3600.0),
    "m / s^2": SiUnit("m/s^2"),
    "l / min": SiUnit("m^3/s", 1e-3 / 60.0),
    "m^3 / s": SiUnit("m^3/s"),
    # masses
    "kg": SiUnit("kg"),
    "mg": SiUnit("kg", 1e-6),
    "kg m^2": SiUnit("kg m^2"),
    "kg / mm": SiUnit("kg/m", 1e3),
    "kg / dm^3": SiUnit("kg/m^3", 1e3),
    # forces, stresses, stiffness
    "N": SiUnit("N"),
    "kN": SiUnit("N", 1e3),
    "N m": SiUnit("N m"),
    "N / m": SiUnit("N/m"),
    "N / mm": SiUnit("N/m", 1e3),
    "N / rad": SiUnit("N/rad"),
    "N mm / rad": SiUnit("N m/rad", 1e-3),
    "N / (mm mum)": SiUnit("N/m/m", 1e9),
    "Pa": SiUnit("Pa"),
    "MPa": SiUnit("Pa", 1e6),
    "N / mm^2": SiUnit("Pa", 1e6),
    "(N / mm^2)^0.5": SiUnit("Pa^0.5", 1e3),
    "mm^2 / N": SiUnit("1/Pa", 1e-6),
    "1e-6 mm^3 / (N m)": SiUnit("1/Pa", 1e-15),
    "mPa s": SiUnit("Pa s", 1e-3),
    "mm^2 / s": SiUnit("m^2/s", 1e-6),
    # heat and power
    "C": SiUnit("K", 1.0, 273.15),
    "K": SiUnit("K"),
    "K / mus": SiUnit("K/s", 1e6),
    "1e-6 / C": SiUnit("1/K", 1e-6),
    "W": SiUnit("W"),
    "kW": SiUnit("W", 1e3),
    "W / mm": SiUnit("W/m", 1e3),
    "W / (m K)": SiUnit("W/(m K)"),
    "W / (m^2 K)": SiUnit("W/(m^2 K)"),
    "J / (kg K)": SiUnit("J/(kg K)"),
    "K m^2 / W": SiUnit("K m^2/W"),
    "K (m / s)^0.75 mm^1.75 / W": SiUnit("K (m/s)^0.75 m^1.75/W", 1e-3**1.75),
    "N / (mm s^0.5 K)": SiUnit("N/(m s^0.5 K)", 1e3),
    # electricity
    "V": SiUnit("V"),
    "V / m": SiUnit("V/m"),
    "Ohm": SiUnit("Ohm"),
    "pF": SiUnit("F", 1e-12),
    "pS / m": SiUnit("S/m", 1e-12),
}
"""Every unit of REXS 1.0 to 2.0.0. A turn is 2 pi rad. Each hardness is a quantity of its own. Stiffness
per face width (N/m/m) is no pressure."""


def _same_in_si(first: str, second: str) -> bool:
    """Return whether two units of REXS are spellings of one."""
    return UNITS[first] == UNITS[second]


def si_value(value: float, unit: str | None, expected: str, place: str) -> float:
    """Return a value in SI.

    Parameters
    ----------
    value, unit : float, str or None
        As the file has them.
    expected : str
        A unit of the value's quantity, as the schema has it.
    place : str
        Component and attribute, for the error.

    Raises
    ------
    BadInput
        The unit is none of REXS, or of another quantity.
    """
    written = UNITS.get("none" if unit is None else unit)
    wanted = UNITS[expected]
    if written is None or written.si != wanted.si:
        fit = ", ".join(name for name, own in UNITS.items() if own.si == wanted.si and name)
        raise refused(f"{place}, unit", unit, f"one of {fit}")
    return value * written.factor + written.offset


VERSIONS = ("1.0", "1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0.0")
NEWEST = VERSIONS[-1]
_SHORT = {"2.0": "2.0.0"}


@dataclass(frozen=True)
class Change:
    """What a version changed of a model.

    Attributes
    ----------
    version : str
        The version that changed it.
    place : str
        The component, and its load case.
    item : str
        Name of the attribute, or type of the component, before.
    kept : bool
        Whether it stays as it was, since the newer version has nothing that says the same.
    words : str
        What became of it, or why it is kept.
    """

    version: str
    place: str
    item: str
    kept: bool
    words: str


@dataclass(frozen=True)
class _Step:
    """What a version renamed, moved, retyped and removed: a file of `steps`."""

    version: str
    components_removed: frozenset[str]
    removed: frozenset[str]
    renamed: dict[str, str]
    units: dict[str, list[str]]
    kinds: dict[str, list[str]]
    moved: dict[str, list[str]]
    enums: dict[str, dict[str, Any]]


def upgrade(model: Model, version: str = NEWEST) -> tuple[Model, tuple[Change, ...]]:
    """Return a model in a newer version of REXS, and what changed; one of that version or a newer as it is.

    Names and spellings that the changelogs of REXS rename are renamed. What they remove, move to another
    component or give another quantity stays as it is and is reported.

    Raises
    ------
    BadInput
        The model's version is not known.
    """
    start, end = _version_number(model.version), _version_number(version)
    changes: list[Change] = []
    for old, new in zip(VERSIONS[start:end], VERSIONS[start + 1 : end + 1], strict=True):
        model = _stepped(model, _step(old, new), changes)
    return model, tuple(changes)


def _version_number(version: str) -> int:
    """Return the index of a version in `VERSIONS`; 2.0 is 2.0.0.

    Raises
    ------
    BadInput
        It is not known.
    """
    name = _SHORT.get(version, version)
    if name not in VERSIONS:
        raise refused("version", version, "one of " + ", ".join(VERSIONS))
    return VERSIONS.index(name)


@functools.cache
def _step(old: str, new: str) -> _Step:
    """Return the step between neighboring versions."""
    name = f"steps/{old}_to_{new}.toml"
    table = tomllib.loads(files("lineofaction.gearbox.rexs").joinpath(name).read_text(encoding="utf-8"))
    attributes = table["attributes"]
    return _Step(
        version=new,
        components_removed=frozenset(table["components"]["removed"]),
        removed=frozenset(attributes["removed"]),
        renamed=attributes["renamed"],
        units=attributes["units"],
        kinds=attributes["kinds"],
        moved=table["moved"],
        enums=table["enums"],
    )


def _stepped(model: Model, step: _Step, changes: list[Change]) -> Model:
    """Return a model one version newer; what changes goes to `changes`."""
    places = (place for place, _ in model.all_components())

    def newer(component: Component) -> Component:
        return _component(component, step, next(places), changes)

    return replace(
        model,
        version=step.version,
        components=tuple(map(newer, model.components)),
        spectra=tuple(
            replace(
                spectrum,
                cases=tuple(
                    replace(case, components=tuple(map(newer, case.components))) for case in spectrum.cases
                ),
                accumulation=None
                if spectrum.accumulation is None
                else tuple(map(newer, spectrum.accumulation)),
            )
            for spectrum in model.spectra
        ),
    )


def _component(component: Component, step: _Step, place: str, changes: list[Change]) -> Component:
    """Return a component one version newer."""
    if component.type in step.components_removed:
        changes.append(Change(step.version, place, component.type, True, "components of this type are gone"))
        return component
    names = {attribute.id for attribute in component.attributes}
    attributes = []
    for attribute in component.attributes:
        for change in (_unit, _kind, _enum):
            attribute, words, kept = change(attribute, step)  # noqa: PLW2901  # the attribute as it goes
            if words:
                changes.append(Change(step.version, place, attribute.id, kept, words))
        name, words = _name(component.type, attribute.id, step, names)
        if words:
            changes.append(Change(step.version, place, attribute.id, name == attribute.id, words))
        attributes.append(replace(attribute, id=name))
    return replace(component, attributes=tuple(attributes))


_Changed = tuple[Attribute, str, bool]


def _name(component: str, name: str, step: _Step, names: set[str]) -> tuple[str, str]:
    own = f"{component}.{name}"
    if own in step.moved:
        targets = ", ".join(step.moved[own])
        return name, f"the component has it no more{f'; these have it now: {targets}' if targets else ''}"
    if name in step.removed:
        return name, "the attribute is gone"
    later = step.renamed.get(own, step.renamed.get(name, name))
    if later != name and later in names:
        return name, f"renamed to {later}, which the component has besides"
    return later, f"renamed to {later}" if later != name else ""


def _unit(attribute: Attribute, step: _Step) -> _Changed:
    """Respell a unit; a value whose unit becomes another quantity is kept in its own."""
    old, new = step.units.get(attribute.id, (None, None))
    if new is None or attribute.unit != old:
        return attribute, "", False
    if _same_in_si(str(old), new):
        return replace(attribute, unit=new), f"unit {old} is spelled {new}", False
    return attribute, f"the unit is {new} now; the value is in {old}", True


def _kind(attribute: Attribute, step: _Step) -> _Changed:
    """Give a value its newer type where it has the same meaning."""
    old, new = step.kinds.get(attribute.id, (None, None))
    if new is None or attribute.kind != old:
        return attribute, "", False
    value = attribute.value
    if isinstance(value, tuple) and len(value) == 1 and old in _UNWRAPPED:
        return replace(attribute, kind=new, value=_first(value), code=None), f"type {old} is {new}", False
    return attribute, f"the type is {new} now; the value is of type {old}", True


_UNWRAPPED = ("floating_point_array", "floating_point_matrix")


def _first(value: tuple[Any, ...]) -> Value:
    """Return the only entry."""
    entry: Value = value[0]
    return entry


def _enum(attribute: Attribute, step: _Step) -> _Changed:
    """Rename a value of an enum."""
    table = step.enums.get(attribute.id, {})
    value = str(attribute.value)
    if value in table.get("renamed", {}):
        later = table["renamed"][value]
        return replace(attribute, value=later, kind="enum"), f"value {value} is {later}", False
    if attribute.value is not None and value in table.get("removed", []):
        return attribute, f"the value {value} is gone", True
    return attribute, "", False
