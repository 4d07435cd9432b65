"""Equality of records by content: what their files give back is equal, any other number is not."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

from bounds.brief import brief
from bounds.content_equality import equal_content


@brief
@dataclass(frozen=True)
class Line:
    x: np.ndarray[Any, Any]
    names: tuple[str, ...] = ()
    error: float = float("nan")
    receipt: dict[str, Any] = field(default_factory=dict)
    inner: object = None


@brief
@dataclass(frozen=True, eq=False)
class Grid:
    x: np.ndarray[Any, Any]


X = np.array([0.0, np.nan, 2.0])


def test_copies_are_equal_nan_included_and_lists_of_files_are_tuples():
    line = Line(X, ("a",), receipt={"steps": [1, 2]}, inner=Line(X))
    assert line == Line(X.copy(), ["a"], receipt={"steps": (1, 2)}, inner=Line(X.copy()))


@pytest.mark.parametrize(
    "change",
    [
        {"x": X + 1.0},
        {"x": X[:2]},
        {"x": X.astype(np.float32)},
        {"x": X.tolist()},
        {"names": ("b",)},
        {"error": 0.0},
        {"receipt": {"steps": 1}},
        {"inner": Line(X)},
    ],
)
def test_another_value_of_any_field_is_another_record(change):
    line = Line(X)
    assert line != replace(line, **change)
    assert replace(line, **change) != line


def test_records_of_other_types_are_others():
    assert Line(X) != Grid(X) and Line(X) != 0 and Grid(X) != X.tolist()
    assert not equal_content(Line(X), Line)


def test_equal_records_without_a_hash_of_fields_have_equal_hashes():
    assert Grid(X) == Grid(X.copy()) and len({Grid(X), Grid(X.copy()), Grid(X + 1.0)}) == 2
    with pytest.raises(TypeError, match="unhashable"):
        hash(Line(X))
