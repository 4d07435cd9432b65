"""Upgrades of REXS: renamed items get their new names, removed items stay and are reported."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Component, Model, Value
from lineofaction.gearbox.rexs.vocabulary import table, units

VERSIONS = ("1.0", "1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0.0")
NEWEST = VERSIONS[-1]
_SHORT = {"2.0": "2.0.0"}
_Step = dict[str, Any]
"""Changes by one version, as a file of `steps` lists them: renamed, moved, retyped and removed."""
_Changed = tuple[Attribute, str, bool]
_UNWRAPPED = ("floating_point_array", "floating_point_matrix")


@dataclass(frozen=True)
class Change:
    """A change that an upgrade to a version makes in a model, or cannot make."""

    version: str
    """The version that changed it."""
    location: str
    """The component, and its load case."""
    item: str
    """Name of the attribute, or type of the component, before."""
    unchanged: bool
    """Whether the item stays as it was, since the newer version has no equivalent."""
    text: str
    """New name, place or type of the item, or the reason why it stays."""


def upgrade(model: Model, version: str = NEWEST) -> tuple[Model, tuple[Change, ...]]:
    """Return a model in a newer version of REXS, and the changes; a model of that version stays as it is.

    Names and spellings that the changelogs of REXS rename are renamed. What they remove, move to another
    component or give another quantity stays as it is and is reported.

    Raises `BadInput`: the model's version is not known.
    """
    start, end = _version_number(model.version), _version_number(version)
    changes: list[Change] = []
    for old, new in zip(VERSIONS[start:end], VERSIONS[start + 1 : end + 1], strict=True):
        step = table(f"steps/{old}_to_{new}")
        newer = partial(_component, step=step, version=new, changes=changes)
        model = replace(model.mapped(newer), version=new)
    return model, tuple(changes)


def _version_number(version: str) -> int:
    name = _SHORT.get(version, version)
    if name not in VERSIONS:
        raise BadInput.of("version", version, "one of " + ", ".join(VERSIONS))
    return VERSIONS.index(name)


def _component(
    location: str, component: Component, step: _Step, version: str, changes: list[Change]
) -> Component:
    if component.type in step["components"]["removed"]:
        reason = "components of this type are gone"
        changes.append(Change(version, location, component.type, unchanged=True, text=reason))
        return component
    names = {attribute.id for attribute in component.attributes}
    attributes = []
    for attribute in component.attributes:
        for change in (_unit, _kind, _enum):
            attribute, text, former = change(attribute, step)  # noqa: PLW2901  # the attribute as it goes
            if text:
                changes.append(Change(version, location, attribute.id, former, text))
        name, text = _name(component.type, attribute.id, step, names)
        if text:
            changes.append(Change(version, location, attribute.id, name == attribute.id, text))
        attributes.append(replace(attribute, id=name))
    return replace(component, attributes=tuple(attributes))


def _name(component: str, name: str, step: _Step, names: set[str]) -> tuple[str, str]:
    qualified = f"{component}.{name}"
    if qualified in step["moved"]:
        targets = ", ".join(step["moved"][qualified])
        return name, f"the component has it no more{f'; these have it now: {targets}' if targets else ''}"
    if name in step["attributes"]["removed"]:
        return name, "the attribute is gone"
    later = step["attributes"]["renamed"].get(qualified, step["attributes"]["renamed"].get(name, name))
    if later != name and later in names:
        return name, f"renamed to {later}, which the component has besides"
    return later, f"renamed to {later}" if later != name else ""


def _unit(attribute: Attribute, step: _Step) -> _Changed:
    """Respell a unit; a value whose unit becomes another quantity is kept in its own."""
    old, new = step["attributes"]["units"].get(attribute.id, (None, None))
    if new is None or attribute.unit != old:
        return attribute, "", False
    if units()[str(old)] == units()[new]:
        return replace(attribute, unit=new), f"unit {old} is spelled {new}", False
    return attribute, f"the unit is {new} now; the value is in {old}", True


def _kind(attribute: Attribute, step: _Step) -> _Changed:
    """Give a value its newer type where it has the same meaning."""
    old, new = step["attributes"]["kinds"].get(attribute.id, (None, None))
    if new is None or attribute.kind != old:
        return attribute, "", False
    value = attribute.value
    if isinstance(value, tuple) and len(value) == 1 and old in _UNWRAPPED:
        only: Value = value[0]
        return replace(attribute, kind=new, value=only, code=None), f"type {old} is {new}", False
    return attribute, f"the type is {new} now; the value is of type {old}", True


def _enum(attribute: Attribute, step: _Step) -> _Changed:
    table = step["enums"].get(attribute.id, {})
    value = str(attribute.value)
    if value in table.get("renamed", {}):
        later = table["renamed"][value]
        return replace(attribute, value=later, kind="enum"), f"value {value} is {later}", False
    if attribute.value is not None and value in table.get("removed", []):
        return attribute, f"the value {value} is gone", True
    return attribute, "", False
