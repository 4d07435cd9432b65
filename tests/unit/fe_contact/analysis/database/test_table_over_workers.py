"""A table cut between its positions and put together again has the bits of one that was not."""

import pickle
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import radians
from typing import Any

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import Gear, GearPair, PitchDeviation, SteDatabase, analyze, study_sensitivity
from fe_contact.analysis.pairs import contact_lines
from fe_contact.analysis.pairs.contact_block import ContactBlock
from fe_contact.geometry import FlankModification, Shaft
from fe_contact.options import Run
from model_studies.workers import InProcess, RunCost, dispatch

pytestmark = pytest.mark.usefixtures("coarse_sectors")

SKEWED = {"misalignments": [-10e-6, 25e-6], "center_distance_changes": [0.0, 80e-6]}
OF_TIME = ("stages", "cpu_seconds", "wall_seconds", "peak_memory_bytes", "prediction", "elsewhere", "passes")


@dataclass(frozen=True)
class Elsewhere:
    """Workers at whom everything arrives pickled, as at those of another machine; they keep a list."""

    cost: RunCost = field(default_factory=RunCost)
    tasks: list[str] = field(default_factory=list)
    blocks: list[ContactBlock] = field(default_factory=list)

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        received = pickle.loads(pickle.dumps(shared))
        for item in items:
            self.tasks.append(function.__name__)
            if isinstance(item, ContactBlock):
                self.blocks.append(item)
            result = function(received, pickle.loads(pickle.dumps(item)))
            self.cost.tasks, self.cost.cpu_seconds = self.cost.tasks + 1, self.cost.cpu_seconds + 100.0
            yield pickle.loads(pickle.dumps(result))


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


@pytest.fixture(autouse=True)
def small_tasks(monkeypatch):
    """Cut small tables as large ones are."""
    monkeypatch.setattr(contact_lines, "TASK_SECONDS", 0.002)
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.0)


def gear(**other: Any) -> Gear:
    plain: dict[str, Any] = {"teeth": 20, "normal_module": 4e-3, "face_width": 20e-3, "bore_diameter": 40e-3}
    return Gear(**plain | {"thickness_allowance": 60e-6} | other)


def helical() -> GearPair:
    relieved = FlankModification(tip_relief=8e-6, tip_relief_length=2e-3, helix_crowning=4e-6)
    first = gear(helix_angle=radians(15), modification=relieved)
    return GearPair(first, gear(helix_angle=-radians(15), teeth=23))


def spur() -> GearPair:
    """The largest modification of a block is not that of all positions: it differs from one to the next."""
    relieved = FlankModification(tip_relief=8e-6, tip_relief_length=2e-3, profile_crowning=3e-6)
    return GearPair(gear(modification=relieved), gear())


def erring() -> GearPair:
    pair, cumulative = spur(), tuple(np.random.default_rng(21).normal(0.0, 3e-6, 20))
    return replace(pair, pinion=replace(pair.pinion, pitch_deviation=PitchDeviation(cumulative)))


def on_shafts() -> GearPair:
    shaft = Shaft(length=0.2, diameter=0.03, position=0.1)
    return replace(helical(), shafts=(shaft, shaft))


CASES: dict[str, tuple[Callable[[], GearPair], dict[str, Any]]] = {
    "modified flanks, both axes": (helical, SKEWED | {"positions": 12}),
    "positions searched": (spur, {"model": "plane_strain", "center_distance_changes": [0.0, 80e-6]}),
    "edges checked afterwards": (helical, SKEWED | {"positions": 12, "effects": {"corner_contact": "off"}}),
    "shafts": (on_shafts, {"positions": 20}),
    "pitch deviations in the plane": (erring, {"model": "plane_strain", "positions": 20}),
    "inserted alignments": (helical, SKEWED | {"positions": 12, "level": None, "tolerance": 0.2}),
}


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("case", CASES)
def test_a_table_cut_into_blocks_keeps_its_bits(case, cache):
    pair, asked = CASES[case]
    asked = {"torques": [60.0, 150.0], "level": "draft", "cache": cache} | asked
    workers = Elsewhere()
    whole, cut = analyze(pair(), **asked), analyze(pair(), **asked, workers=workers)
    assert workers.tasks.count("solve_block") > 2 and "condense" not in workers.tasks
    assert_same(whole, cut)
    assert whole.inserted_misalignment.size == (1 if case == "inserted alignments" else 0)


def test_errors_and_influences_are_tasks_too(cache):
    """Held-out points are cut as the table is; they bring its compliance and start from its solutions."""
    asked: dict[str, Any] = {"torques": [60.0, 150.0], "level": "draft", "cache": cache} | SKEWED
    workers = Elsewhere()
    table = analyze(helical(), **asked, positions=12, workers=workers)
    begun = workers.tasks.index("_influences_of_request")
    assert workers.tasks[:begun].count("solve_block") == workers.tasks.count("solve_block")
    held_out = [block for block in workers.blocks if block.starts is not None]
    # the quarters and the middle between two misalignments share a compliance
    assert {len(block.models) for block in held_out} == {3} and len(held_out) == 2
    assert all(block.assembled is not None for block in held_out)
    assert set(table.metadata.receipt["held_out"]) == {"force", "misalignment", "center_distance_change"}


def assert_same(one: SteDatabase, other: SteDatabase) -> None:
    """Every array and every figure of the receipt, but for time and memory."""
    for name in one.__dataclass_fields__:
        if isinstance(getattr(one, name), np.ndarray):
            np.testing.assert_array_equal(getattr(other, name), getattr(one, name), err_msg=name)
    first, second = (
        {k: v for k, v in each.metadata.receipt.items() if k not in OF_TIME} for each in (one, other)
    )
    assert second == first


def test_gears_condensed_elsewhere_are_the_same(cache):
    workers = Elsewhere()
    asked: dict[str, Any] = {"torques": [100.0], "level": "draft", "positions": 16}
    whole = analyze(helical(), **asked, cache=cache)
    cut = analyze(helical(), **asked, workers=workers)  # nowhere to keep them
    assert workers.tasks.count("condense") == 4  # both gears, on both meshes
    assert_same(whole, cut)


def test_the_receipt_counts_the_time_of_all(cache):
    """Every task is said to have cost 100 s: they show in the stages they were part of, and nowhere else."""
    workers = Elsewhere(RunCost(tasks=7, cpu_seconds=900.0))  # what other runs spent before
    asked: dict[str, Any] = {"torques": [60.0, 150.0], "level": "draft", "positions": 16, "cache": cache}
    receipt = analyze(helical(), **asked, workers=workers).metadata.receipt
    in_contact = 100.0 * workers.tasks.count("solve_block")
    assert receipt["elsewhere"]["tasks"] == len(workers.tasks)
    assert receipt["elsewhere"]["cpu_seconds"] == pytest.approx(100.0 * len(workers.tasks))
    assert in_contact <= receipt["stages"]["contact"]["cpu_seconds"] < in_contact + 100.0
    assert 0.0 <= receipt["cpu_seconds"] - 100.0 * len(workers.tasks) < 100.0
    assert "elsewhere" not in analyze(helical(), **asked).metadata.receipt


def test_tasks_do_not_depend_on_who_works(cache):
    asked: dict[str, Any] = {"torques": [60.0], "level": "draft", "positions": 16, "cache": cache}
    first, second = Elsewhere(), Elsewhere()
    for workers in (first, second):
        analyze(helical(), **asked, workers=workers)
    assert first.tasks == second.tasks


def test_too_little_to_send_stays_here(monkeypatch):
    """A table as a whole: its gears as well, which nobody has condensed."""
    monkeypatch.setattr(dispatch, "START_SECONDS", 1e3)
    workers = Elsewhere()
    analyze(helical(), torques=[60.0], level="draft", positions=16, workers=workers)
    assert not workers.tasks


def test_sensitivity_over_workers_keeps_its_bits(cache):
    workers = Elsewhere()
    asked: dict[str, Any] = {
        "normal_forces": [2000.0], "misalignments": [20e-6], "center_distance_changes": [50e-6],
        "level": "draft", "positions": 16,
    }  # fmt: skip
    here, there = (
        study_sensitivity(helical(), *table_request(**asked), Run(workers=who, cache=cache))
        for who in (InProcess(), workers)
    )
    for one, other in zip(here, there, strict=True):
        for name in ("misalignment", "center_distance_change"):
            first, second = getattr(one, name), getattr(other, name)
            assert first.peak_to_peak.tolist() == second.peak_to_peak.tolist()
            assert first.error.tolist() == second.error.tolist()
    assert workers.tasks.count("solve_block") > 8  # four tables as tasks would be four
