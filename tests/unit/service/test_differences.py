"""What sets a job apart: differences of inputs, and the words for them."""

import json
from typing import Any

import pytest

from service.queue.differences import differences_between, differences_column, differences_of
from service.queue.job import subject_of
from service.schemas.answers import Difference
from service.schemas.examples import CASE, SCENE


def between(before: Any, now: Any) -> list[tuple[str, Any, Any]]:
    found = differences_between(before, now).first
    return [(difference.field, difference.before, difference.value) for difference in found]


@pytest.mark.parametrize(
    ("before", "now", "differences"),
    [
        ({"a": 1, "b": {"c": [1, 2]}}, {"a": 1, "b": {"c": [1, 2]}}, []),
        ({"a": {"b": 1.0}}, {"a": {"b": 2.5}}, [("a.b", 1.0, 2.5)]),
        ({"a": True}, {"a": 1}, [("a", True, 1)]),
        ({"a": None, "b": 1}, {"b": 1}, []),
        ({}, {"a": "x"}, [("a", None, "x")]),
        ({"t": [1, 2]}, {"t": [1, 2, 3]}, [("t", [1, 2], [1, 2, 3])]),
        ({"t": [1, 2]}, {"t": list(range(17))}, [("t", [1, 2], "list of 17")]),
        ({"t": [[1], [2]]}, {"t": [[1], [3]]}, [("t", "list of 2", "list of 2")]),
        ({"s": [{"d": 1}, {"d": 2}]}, {"s": [{"d": 1}, {"d": 3}]}, [("s[1].d", 2, 3)]),
        ({"s": [{"d": 1}]}, {"s": [{"d": 1}, {"d": 2}]}, [("s[1].d", None, 2)]),
        ({"x": "a"}, {"x": "b" * 201}, [("x", "a", "text of 201 characters")]),
    ],
)
def test_differences_are_those_of_the_leaves(before, now, differences):
    assert between(before, now) == differences


def test_the_first_twelve_are_kept_and_all_are_counted():
    found = differences_between({}, {f"x{n}": n for n in range(40)}, "there")
    assert (found.number, found.since) == (40, "there")
    assert [difference.field for difference in found.first] == [f"x{n}" for n in range(12)]
    assert differences_of(differences_column(found)) == found
    assert found.first[3] == Difference(field="x3", before=None, value=3)


def test_the_subject_names_the_pair_or_the_scene():
    assert subject_of(json.dumps({"case": CASE})) == "20/20, module 4 mm, up to 400 N m"
    assert subject_of(json.dumps({"scene": SCENE})) == "scene of 1 mesh"
    assert subject_of(json.dumps({"wish": {}})) == ""
