"""The reference files of REXS (folder LOA_REXS_REFERENCE), in the form of the project's tables."""

import functools
import itertools
import os
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import pytest

SETTING = "LOA_REXS_REFERENCE"
SCHEMAS = ("2.0.0", "1.7", "1.4", "1.0")
VERSIONS = ("1.0", "1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0.0")
STEPS = tuple(itertools.pairwise(VERSIONS))

_folder = Path(os.environ.get(SETTING) or "/nonexistent")
needs_reference = pytest.mark.skipif(
    not (_folder / "examples").is_dir(), reason=f"{SETTING} names no folder of REXS reference files"
)


def reference(name: str) -> Path:
    return _folder / name


def examples() -> list[Path]:
    """Return the example files, none without the folder."""
    return sorted((_folder / "examples").glob("*.rexs*"))


@functools.cache
def parsed_schema(version: str) -> Element:
    return ElementTree.parse(reference(f"schema/rexs_schema_{version}.xml")).getroot()


@functools.cache
def attributes_of(version: str) -> dict[str, tuple[str, str, list[str]]]:
    root = parsed_schema(version)
    units = {unit.get("id"): unit.get("name") or "" for unit in root.iterfind("units/unit")}
    kinds = {kind.get("id"): kind.get("name") or "" for kind in root.iterfind("valueTypes/valueType")}
    return {
        str(attribute.get("attributeId")): (
            kinds[attribute.get("valueType")],
            units[attribute.get("unit")],
            [str(value.get("value")) for value in attribute.iter("enumValue")],
        )
        for attribute in root.iterfind("attributes/attribute")
    }


def owners(version: str) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for entry in parsed_schema(version).iter("componentAttributeMapping"):
        found.setdefault(str(entry.get("attributeId")), set()).add(str(entry.get("componentId")))
    return found


@functools.cache
def changelog(old: str, new: str) -> Element:
    return ElementTree.parse(reference(f"changelog/rexs_changelog_{old}_to_{new}.xml")).getroot()


@functools.cache
def names_at(version: str) -> dict[str, str]:
    """Return the attributes of a version by their numbers, from the schema of 1.0 by the changelogs.

    A name may stand for several numbers; what the changelog removes or renames is a number.
    """
    root = parsed_schema("1.0")
    names = {
        str(at.get("numericId")): str(at.get("attributeId")) for at in root.iterfind("attributes/attribute")
    }
    for old, new in STEPS[: VERSIONS.index(version)]:
        for change in changelog(old, new).iterfind("attributeChanges/attributeChange"):
            number, kind = str(change.get("numericId")), change.get("type")
            edits = {value.get("key"): str(value.get("newValue")) for value in change.iter("changedValue")}
            former = names.pop(number, str(change.get("id")))
            if kind != "DELETE":
                names[edits.get("numericId", number)] = edits.get("attributeId", former)
    return names


@functools.cache
def holders() -> dict[tuple[str | None, str | None], list[str]]:
    """Return the components that have the attribute of a name and a number in any schema."""
    parts_of: dict[tuple[str | None, str | None], set[str]] = {}
    for version in SCHEMAS:
        for entry in parsed_schema(version).iterfind("componentAttributeMappings/componentAttributeMapping"):
            key = entry.get("attributeId"), entry.get("attributeNumericId")
            parts_of.setdefault(key, set()).add(str(entry.get("componentId")))
    return {key: sorted(parts) for key, parts in parts_of.items()}


def step_of(old: str, new: str) -> dict[str, Any]:
    """Return what a changelog says, in the form of `lineofaction/gearbox/rexs/steps`."""
    root = changelog(old, new)
    changes = root.findall("attributeChanges/attributeChange")
    lasting = set(names_at(new).values())
    removed = {str(change.get("id")) for change in changes if change.get("type") == "DELETE"} - lasting
    renamed = {}
    for change in changes:
        for name, (_, later) in _edits([change], "attributeId").items():
            parts = holders()[name, change.get("numericId")] if name in lasting else []
            renamed |= {f"{part}.{name}": later for part in parts} or {name: later}
    return {
        "from": root.get("fromVersion"),
        "to": root.get("toVersion"),
        "components": {"removed": _ids(root, "componentChanges/componentChange", "DELETE")},
        "attributes": {
            "removed": sorted(removed),
            "renamed": dict(sorted(renamed.items())),
            "units": _edits(changes, "unit"),
            "kinds": _edits(changes, "valuetype"),
        },
        "enums": dict(sorted(filter(lambda item: item[1], map(_enum, changes)))),
        "moved": _moved(root, removed),
    }


def other_changes(old: str, new: str) -> list[str]:
    """Return what a changelog renames or removes that the project's steps have no place for."""
    root = changelog(old, new)
    paths = ("relationChanges/relationChange", ".//roleChange")
    entries = [entry for path in paths for entry in root.iterfind(path)]
    removed = [ElementTree.tostring(entry).decode() for entry in entries if entry.get("type") == "DELETE"]
    keys = ("componentId", "relationId", "roleId", "orderRequired")
    return removed + [str(value.attrib) for value in root.iter("changedValue") if value.get("key") in keys]


def _ids(root: Element, path: str, change: str) -> list[str]:
    return sorted(str(entry.get("id")) for entry in root.iterfind(path) if entry.get("type") == change)


def _edits(changes: list[Element], key: str) -> dict[str, list[str]]:
    pairs = {
        str(change.get("id")): [str(value.get("oldValue")), str(value.get("newValue"))]
        for change in changes
        for value in change.iterfind("changedValues/changedValue")
        if value.get("key") == key
    }
    return dict(sorted(pairs.items()))


def _enum(change: Element) -> tuple[str, dict[str, Any]]:
    removed, renamed = [], {}
    for entry in change.iter("enumValueChange"):
        if entry.get("type") == "DELETE":
            removed.append(str(entry.get("value")))
        for value in entry.iter("changedValue"):
            if value.get("key") == "value":
                renamed[str(value.get("oldValue"))] = str(value.get("newValue"))
    table: dict[str, Any] = {"removed": sorted(removed)} if removed else {}
    return str(change.get("id")), table | ({"renamed": dict(sorted(renamed.items()))} if renamed else {})


def _moved(root: Element, removed: set[str]) -> dict[str, list[str]]:
    """Return the components that have an attribute now, by ``component.attribute`` that has it no more."""
    mappings = root.findall("mappingChanges/mappingChange")
    new: dict[str, set[str]] = {}
    for entry in mappings:
        if entry.get("type") == "ADD":
            new.setdefault(str(entry.get("attributeId")), set()).add(str(entry.get("componentId")))
    same = removed | set(_ids(root, "attributeChanges/attributeChange", "ADD"))
    moved = {}
    for entry in mappings:
        part, name = str(entry.get("componentId")), str(entry.get("attributeId"))
        if entry.get("type") == "DELETE" and name not in same and part not in new.get(name, ()):
            moved[f"{part}.{name}"] = sorted(new.get(name, ()))
    return dict(sorted(moved.items()))


def kinds_to_list() -> dict[str, set[str]]:
    """Return the attributes whose kind their text does not show, by kind of an entry."""
    kinds = _kinds_of_schemas()
    for old, new in reversed(STEPS):
        for name, later in step_of(old, new)["attributes"]["renamed"].items():
            if later in kinds and "." not in name:
                kinds.setdefault(name, kinds[later])
    listed: dict[str, set[str]] = {}
    for name, kind in kinds.items():
        listed.setdefault(kind, set()).add(name)
    return listed


def _kinds_of_schemas() -> dict[str, str]:
    """Return the kind of an entry, which text does not show, by the newest schema of each attribute."""
    kinds: dict[str, str] = {}
    for version in SCHEMAS:
        for name, (kind, _, _) in attributes_of(version).items():
            if entry_kind(kind) not in ("floating_point", "boolean"):
                kinds.setdefault(name, entry_kind(kind))
    return kinds


def entry_kind(kind: str) -> str:
    return (
        kind.removeprefix("array_of_").removesuffix("_arrays").removesuffix("_array").removesuffix("_matrix")
    )
