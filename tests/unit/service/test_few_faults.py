"""The search for faults ends when enough is wrong; what is right is found right as before."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError

from lineofaction.gearbox.problems import BadInput, Fault
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from service.schemas.examples import CASE, SCENE

MANY = 100_000
SPOILED: dict[str, tuple[type[BoundaryModel], dict[str, Any]]] = {
    "unknown fields": (Case, CASE | {f"field{number}": 0 for number in range(MANY)}),
    "texts for numbers": (Case, CASE | {"load": {"torque_n_m": ["a"] * MANY}}),
    "texts for rows": (Case, {"pair": {"pinion": {"flank_grid": {"removed_um": [["a"] * 500] * MANY}}}}),
    "tables without fields": (SceneInput, SCENE | {"shafts": [{}] * MANY}),
    "texts for tables": (SceneInput, SCENE | {"shafts": [""] * MANY}),
    "names of effects": (SceneInput, SCENE | {"effects": {f"effect{number}": 0 for number in range(MANY)}}),
}


@pytest.mark.parametrize("kind", SPOILED)
def test_a_search_ends_while_it_finds(kind: str) -> None:
    model, data = SPOILED[kind]
    with pytest.raises(ValidationError) as caught:
        model.model_validate(data)
    assert 1 <= caught.value.error_count() <= 100


def test_each_of_some_tables_is_told_its_faults() -> None:
    shafts = [{"name": 1, "length": 2.0}] * 12
    with pytest.raises(BadInput) as caught:
        validated(SceneInput, SCENE | {"shafts": shafts})
    fields = {fault.field for fault in caught.value.faults}
    assert {f"shafts[{number}].{field}" for number in range(12) for field in ("name", "length")} <= fields


def test_a_list_that_is_too_long_is_told_its_length_though_its_tables_are_wrong() -> None:
    with pytest.raises(BadInput) as caught:
        validated(SceneInput, SCENE | {"shafts": [{}] * 1001})
    (fault,) = caught.value.faults
    assert (fault.field, fault.bound) == ("shafts", "a list of at most 1000")


@pytest.mark.parametrize(
    "value", [[], {}, [1, "a", [None, {}]], {"a": {"b": [1.5, True]}, 2: "c"}, [[[]]], "text", None, (1,)]
)
def test_a_short_value_is_shown_as_it_is(value: object) -> None:
    shown = str(Fault("field", value, "another"))
    assert shown == f"field = {'nothing' if value is None else repr(value)}: must be another"


def test_of_a_long_value_the_beginning_is_shown() -> None:
    value = {"numbers": list(range(1000)), "texts": ["a" * 1000]}
    assert f"field = {repr(value)[:200]}...: must" in str(Fault("field", value, "another"))


def test_a_name_as_long_as_a_body_is_not_told_whole() -> None:
    with pytest.raises(BadInput) as caught:
        validated(Case, CASE | {"x" * 1_000_000: 1})
    assert len(str(caught.value)) < 1000


def test_what_is_bounded_once_is_not_bounded_again() -> None:
    """The description of the API was too deep to be written: each use of a model had wrapped it once more."""

    class Part(BoundaryModel):
        names: tuple[str, ...]

    class Whole(BoundaryModel):
        first: Part
        others: tuple[Part, ...]

    class Uses(BoundaryModel):
        whole: Whole

    def bounds(node: object) -> int:
        """Return the most functions that see the data of one schema in turn."""
        if not isinstance(node, dict) or node.get("type") != "function-before":
            return 0
        return 1 + bounds(node["schema"])

    schemas: list[Any] = [Uses.__pydantic_core_schema__]
    deepest = 0
    while schemas:
        node = schemas.pop()
        if isinstance(node, dict):
            deepest = max(deepest, bounds(node))
            schemas += node.values()
        elif isinstance(node, list | tuple):
            schemas += node
    assert deepest == 1
