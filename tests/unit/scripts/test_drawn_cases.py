"""A drawn test runs a fifth of its cases by day, all within five versions, and all at night."""

from typing import Any

import drawn_cases
import pytest
from drawn_cases import PART, draw, leave_to_the_night

NAMES = [f"tests/api/test_this.py::test_that[{path}-{wrong}]" for path in range(30) for wrong in "abc"]


@pytest.mark.parametrize("count", [1, 2, 5, 7, 90])
def test_five_turns_draw_every_case(count):
    drawn = [draw(NAMES[:count], turn) for turn in range(168, 168 + PART)]
    assert set().union(*drawn) == set(NAMES[:count])
    assert all(1 <= len(part) <= -(-count // PART) for part in drawn)


def test_what_is_drawn_does_not_depend_on_the_order_of_collection():
    assert draw(NAMES, 3) == draw(reversed(NAMES), 3) != draw(NAMES, 4)


class _Item:
    def __init__(self, number: int) -> None:
        self.nodeid, self.marks = NAMES[number], {"drawn"} | ({"nightly"} if number % 3 else set())

    def get_closest_marker(self, name: str) -> bool:
        return name in self.marks

    def add_marker(self, mark: Any) -> None:
        self.marks.add(mark.name)


@pytest.mark.parametrize("turn", range(PART))
def test_cases_of_the_night_take_no_turn_of_the_day(monkeypatch, turn):
    monkeypatch.setattr(drawn_cases, "_by_day", False)
    monkeypatch.setattr(drawn_cases, "turn", lambda: turn)
    items: list[Any] = [_Item(number) for number in range(3 * PART)]
    leave_to_the_night(items)
    assert len([item for item in items if item.marks == {"drawn"}]) == 1


@pytest.mark.drawn
@pytest.mark.parametrize("case", range(2 * PART))
def test_of_a_drawn_test_a_fifth_runs_by_day(request, case):
    own = f"::{request.node.originalname}["
    collected = [item for item in request.session.items if own in item.nodeid]
    assert len(collected) <= (2 * PART if request.config.getoption("all") else 2)
