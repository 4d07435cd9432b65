"""Examples with other values at dotted places, scenes on the small table, and where they are refused."""

import copy
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import MappingProxyType
from typing import Any

import pytest
from small_table import small_table

from dynamics.scene import Scene
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.problems import BadInput, Fault
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput

Table = dict[str, Any]
DROP = object()


class By(dict[str, Any]):
    """What stands at places where it is not that place that is refused."""


def changed(example: Table, changes: Mapping[str, Any]) -> Table:
    """Return the example with values at places like `bushings[0].name`; `DROP` takes one away."""
    table = copy.deepcopy(example)
    for path, value in changes.items():
        *places, last = [int(part) if part.isdigit() else part for part in re.findall(r"\w+", path)]
        inner: Any = table
        for place in places:
            inner = inner[place] if isinstance(place, int) else inner.setdefault(place, {})
        if value is DROP:
            del inner[last]
        elif isinstance(inner, list) and last == len(inner):
            inner.append(value)
        else:
            inner[last] = value
    return table


Tables = Mapping[str, SteDatabase]
NONE: Mapping[str, Any] = MappingProxyType({})


def changed_scene(example: Table, changes: Mapping[str, Any] = NONE, tables: Tables = NONE) -> Scene:
    checked = validated(SceneInput, changed(example, changes))
    return dynamic_scene(
        checked, {mesh.name: tables.get(mesh.name) or small_table() for _, mesh in checked.with_database}
    )


@contextmanager
def assert_refused(field: str, words: str = "") -> Iterator[list[Fault]]:
    """Check that an input is refused by one fault of a field, whose bound has these words; give it."""
    faults: list[Fault] = []
    with pytest.raises(BadInput) as caught:
        yield faults
    faults += caught.value.faults
    assert [fault.field for fault in faults] == [field]
    assert faults[0].bound and words in faults[0].bound


def check_refused(example: Table, field: str, value: Any, tables: Tables = NONE) -> None:
    """Check that a value at a field, or changes elsewhere, are one fault of that field."""
    with assert_refused(field):
        changed_scene(example, value if isinstance(value, By) else {field: value}, tables)
