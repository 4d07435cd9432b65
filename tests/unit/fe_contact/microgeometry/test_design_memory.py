"""Designs kept on disk: a search that was stopped finds the same, and pays only for the rest."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from analysis_requests import design_request
from spur_gears import PAIR

from fe_contact import DesignVariable, GearPair, Limits, Optimization, Run, Search, optimize
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.objective import WeightedMean, Worst
from fe_contact.microgeometry.search_methods import Cancel, DifferentialEvolution, never

FREE = (
    DesignVariable("pinion.profile_crowning", 0.0, 2e-5),
    DesignVariable("wheel.profile_slope", -1e-5, 1e-5),
)
SEARCH = Search(DifferentialEvolution(), evaluations=60, positions=24, exploration=8)


@pytest.fixture
def solved(monkeypatch):
    """Contact solves of designs, counted."""
    count, evaluate = [0], Evaluator.evaluate

    def counted(self, values):
        count[0] += 1
        return evaluate(self, values)

    monkeypatch.setattr(Evaluator, "evaluate", counted)
    return count


def run(pair: GearPair, memory: Path | None, cancel: Cancel = never, **further: Any) -> Optimization:
    asked: dict[str, Any] = {"torques": [200.0], "variables": FREE, "search": SEARCH, **further}
    request = design_request(pair, map_torques=[200.0], level="draft", model="plane_strain", **asked)
    return optimize(request, Run(), memory=memory, cancel=cancel)


@pytest.mark.law
def test_a_stopped_search_goes_on_where_it_was(tmp_path, solved):
    plain = run(PAIR, None)
    whole, solved[0] = solved[0], 0
    asked = [0]

    def cancel():
        asked[0] += 1
        return asked[0] > 40

    cut = run(PAIR, tmp_path, cancel=cancel)
    assert cut.evaluations < plain.evaluations
    solved[0] = 0
    again = run(PAIR, tmp_path)
    assert again.optimum.values == plain.optimum.values
    assert again.optimum.objective == plain.optimum.objective
    assert [one.assessed for one in again.runs] == [one.assessed for one in plain.runs]
    assert whole - 44 <= solved[0] <= whole - 39  # those before the stop, and its best in full, were known


def test_more_evaluations_go_on_from_fewer(tmp_path, solved):
    run(PAIR, tmp_path)
    solved[0] = 0
    run(PAIR, tmp_path)
    confirming, solved[0] = solved[0], 0
    assert confirming < 20  # of 60: both designs in full, and perturbations
    run(PAIR, tmp_path, search=replace(SEARCH, evaluations=90))
    assert confirming < solved[0] < confirming + 60


def test_what_is_assessed_otherwise_is_not_taken(tmp_path, solved):
    few = replace(SEARCH, evaluations=30)
    run(PAIR, tmp_path, search=few)
    for further in (
        {"torques": [201.0]}, {"limits": Limits(max_pressure=1e9)}, {"objective": WeightedMean((2.0,))},
        {"objective": Worst()}, {"search": replace(few, positions=25, exploration=9)},
    ):  # fmt: skip
        solved[0] = 0
        run(PAIR, tmp_path, **{"search": few, **further})
        assert solved[0] >= 30, further


def test_half_a_record_and_a_spoiled_one_are_left_out(tmp_path, solved):
    whole = run(PAIR, tmp_path)
    (file,) = tmp_path.glob("designs-*.bin")
    text = file.read_bytes()
    record = 8 + 8 * len(FREE) + 24
    assert len(text) % record == 0
    known = len(text) // record
    solved[0] = 0
    run(PAIR, tmp_path)
    confirming = solved[0]
    file.write_bytes(text[:-5])  # killed while it wrote
    solved[0] = 0
    run(PAIR, tmp_path)
    assert solved[0] == confirming + 1
    assert file.read_bytes() == text
    spoiled = bytearray(text)
    spoiled[10 * record + 12] ^= 1
    file.write_bytes(spoiled)
    solved[0] = 0
    again = run(PAIR, tmp_path)
    assert solved[0] == confirming + known - 10
    assert again.optimum.values == whole.optimum.values


def test_a_directory_that_cannot_be_written_costs_nothing(tmp_path):
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    found = run(PAIR, tmp_path / "file" / "searches", search=replace(SEARCH, evaluations=5))
    assert found.evaluations == 5
