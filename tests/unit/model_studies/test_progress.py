"""Progress of parts by their cost."""

import pytest

from model_studies.progress import TableFraction, by_cost


def test_parts_count_by_their_cost():
    seen: list[float] = []
    progress = by_cost(seen.append, {"mesh": 1.0, "ring": 3.0, "free": 0.0})
    for step in (("mesh", 0.5), ("mesh", 1.0), ("ring", 0.5), ("other", 0.1), ("ring", 1.0), ("free", 1.0)):
        progress(*step)
    assert seen == pytest.approx([0.125, 0.25, 0.625, 1.0, 1.0])


def test_what_costs_nothing_is_not_reported():
    seen: list[float] = []
    by_cost(seen.append, {"kept": 0.0})("kept", 1.0)
    assert seen == []


def test_a_pass_that_follows_takes_its_part_of_what_is_left():
    table = TableFraction(refines=True)
    table.plan({"compliance": 3.0, "contact": 1.0})
    first = [table.at(*step) for step in (("compliance", 0.5), ("compliance", 1.0), ("contact", 1.0))]
    table.plan({"compliance": 0.0, "contact": 9.0})
    second = [table.at(*step) for step in (("compliance", 1.0), ("contact", 0.5), ("contact", 1.0))]
    assert first == pytest.approx([0.3, 0.6, 0.8])
    assert second == pytest.approx([0.8, 0.88, 0.96])
    assert table.at("unknown", 0.1) == second[-1]
