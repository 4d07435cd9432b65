"""Records in a dozen lines."""

from dataclasses import dataclass, field, make_dataclass
from enum import Enum
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bounds.brief import MAX_LINES, WIDTH, Row, brief, concise, described_value, html_of, text_of


class Side(Enum):
    LEFT = 1


@brief
@dataclass(frozen=True)
class Ripple:
    position: np.ndarray[Any, Any]
    amplitude: float
    side: Side = Side.LEFT
    note: str = ""
    absent: object = None
    secret: str = field(default="hidden", repr=False)


def test_arrays_are_shape_and_range_numbers_stand_as_they_are():
    lines = repr(Ripple(np.linspace(0.0, 0.984, 64), 1.25e-7, note="two\nlines")).split("\n")
    assert lines == [
        "Ripple",
        "  position   64, 0 to 0.984",
        "  amplitude  125e-9",
        "  side       left",
        "  note       two",
    ]


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (np.array([1.0, 2.5]), "1, 2.5"),
        (np.ones((3, 4)), "3 x 4, all 1"),
        (np.full(9, np.nan), "9 float64"),
        (np.array([True] * 7 + [False]), "8, 7 true"),
        (np.array([]), "none"),
        ((), "none"),
        (("a", "b"), "a, b"),
        (tuple(range(9)), "9: 0, 1, 2, 3, 4, 5, ..."),
        ([Side.LEFT, Side.LEFT], "2 Side"),
        ({"one": 1}, "one"),
        (np.float64(2.0), "2"),
        (float("nan"), "nan"),
    ],
)
def test_values_in_words(value, words):
    assert described_value(value) == words


class Table:
    def headlines(self) -> tuple[str, list[Row]]:
        return "Table <3>", [(f"row {number}", "x" * 200) for number in range(30)]


def test_a_record_that_states_its_lines_is_bounded_too():
    lines = text_of(Table()).split("\n")
    assert len(lines) == MAX_LINES
    assert max(map(len, lines)) == WIDTH
    assert lines[-1].startswith("  and")
    assert "<caption>Table &lt;3&gt;</caption>" in html_of(Table())


VALUES = st.one_of(
    st.floats(),
    st.text(max_size=300),
    st.booleans(),
    st.none(),
    st.lists(st.one_of(st.floats(), st.text(max_size=50)), max_size=20),
    st.dictionaries(st.text(max_size=50), st.integers(), max_size=20),
    st.integers(0, 40).map(lambda size: np.linspace(-1.0, 1.0, size)),
)


@given(st.lists(VALUES, max_size=30))
def test_no_record_takes_more_than_a_dozen_lines(values):
    kind = brief(make_dataclass("Record", [f"field_{number}" for number in range(len(values))]))
    lines = repr(kind(*values)).split("\n")
    assert len(lines) <= MAX_LINES
    assert max(map(len, lines)) <= WIDTH


def test_long_rows_are_wrapped_while_there_are_lines_and_cut_then():
    @brief
    @dataclass(frozen=True)
    class Notes:
        first: str
        second: str = "end"

    lines = repr(Notes("word " * 40)).split("\n")
    assert len(lines) == 1 + 3 + 1 and lines[2].startswith(" " * 10 + "word") and lines[-1].endswith("end")
    lines = repr(Notes("word " * 900)).split("\n")
    assert len(lines) == MAX_LINES and lines[-2].endswith("…") and lines[-1].endswith("end")
    assert max(map(len, lines)) <= WIDTH


def test_a_call_leaves_out_what_has_its_default():
    @concise
    @dataclass(frozen=True)
    class Wheel:
        teeth: int
        width: float = 0.02
        slopes: dict[str, float] = field(default_factory=dict)

    assert repr(Wheel(20)) == "Wheel(teeth=20)"
    assert repr(Wheel(20, 0.03, {"a": 1.0})) == "Wheel(teeth=20, width=0.03, slopes={'a': 1.0})"
