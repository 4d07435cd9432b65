"""The same bits whoever works, here, in a pool or interrupted, and its cost (on clusters: tests/flow)."""

import gc
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from enum import Enum
from math import radians
from multiprocessing import get_context
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np
import pytest
from analysis_requests import design_request
from spur_gears import LONG_RELIEFS, PAIR

from fe_contact import Gear, GearPair, PitchDeviation, analyze
from fe_contact.analysis.pairs import contact_lines
from fe_contact.geometry import FlankModification, Shaft
from fe_contact.microgeometry.optimize import optimize
from fe_contact.microgeometry.scatter import GaussHermite, Scatter
from fe_contact.microgeometry.search import Ended, Search
from fe_contact.microgeometry.search_methods import NelderMead, SequentialLinearProgramming
from fe_contact.microgeometry.tolerance_study import Sampling, ToleranceStudy, scatter
from fe_contact.microgeometry.tolerances import Tolerances
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.options import AnalysisOptions, Run
from lineofaction.gearbox.executor import open_executor
from lineofaction.gearbox.problems import BadInput
from model_studies.workers import (
    ByExecutor,
    InProcess,
    Remembering,
    RunCost,
    Workers,
    WorkersLost,
    dask_workers,
    dispatch,
)
from model_studies.workers.content_digest import content_digest
from model_studies.workers.remote_task import Packed
from model_studies.workers.run_cost import TaskResult

DRAFT: dict[str, Any] = {"level": "draft", "model": "plane_strain"}
SCATTER = Scatter(modification={"wheel.profile_slope": 3e-6}, rule=GaussHermite(2))
SLOPES = Tolerances(0.0, {"pinion.profile_slope": 10e-6, "wheel.profile_slope": 5e-6})


@pytest.fixture(scope="module")
def compliances(tmp_path_factory):
    return tmp_path_factory.mktemp("compliances")


@pytest.fixture(scope="module")
def pair():
    return PAIR


@pytest.fixture(scope="module")
def local(pair, compliances):
    return study(pair, compliances, InProcess())


def study(pair: GearPair, compliances: Path, workers: Workers) -> ToleranceStudy:
    return scatter(
        pair,
        [100.0, 200.0],
        SLOPES,
        Sampling(samples=200, seed=1),
        AnalysisOptions(**DRAFT),
        Run(workers=workers, cache=compliances),
    )


@pytest.fixture(scope="module")
def pool():
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as executor:
        yield ByExecutor(executor)


@pytest.mark.law
def test_a_pool_of_processes_gives_the_same_bits(pair, compliances, local, pool):
    shared = study(pair, compliances, pool)
    np.testing.assert_array_equal(shared.peak_to_peak, local.peak_to_peak)


def test_starts_searched_in_a_pool_find_the_same_designs(pair, compliances, pool):
    variables = [DesignVariable(f"{gear}.profile_crowning", 0.0, 2e-5) for gear in ("pinion", "wheel")]
    search = Search(NelderMead(), starts=3, evaluations=25, positions=16)
    here, there = (
        optimize(
            design_request(pair, [200.0], variables, search=search, map_torques=[200.0], **DRAFT),
            Run(workers=workers, cache=compliances),
        )
        for workers in (InProcess(), pool)
    )
    assert [run.assessed for run in there.runs] == [run.assessed for run in here.runs]
    assert there.optimum.values == here.optimum.values
    assert there.optimum.objective == here.optimum.objective


@pytest.mark.law
@pytest.mark.parametrize("evaluations", [90, 30, 9])
def test_a_single_start_is_divided_and_finds_the_same(
    pair, compliances, pool, evaluations, tmp_path, monkeypatch
):
    """Its sample, its walks, their nodes and those beside its end; also where designs end in mid-walk."""
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.0)
    variables = [DesignVariable(f"{gear}.profile_crowning", 0.0, 2e-5) for gear in ("pinion", "wheel")]
    search = Search(evaluations=evaluations, positions=16, exploration=8)
    here, there = (
        optimize(
            design_request(
                pair, [100.0, 200.0], variables, SCATTER, search=search, map_torques=[200.0], **DRAFT
            ),
            Run(workers=workers, cache=compliances),
            memory=tmp_path / str(isinstance(workers, InProcess)),
        )
        for workers in (InProcess(), pool)
    )
    for mine, theirs in zip(here.runs, there.runs, strict=True):
        np.testing.assert_array_equal(theirs.coordinates, mine.coordinates)
        alone = {"coordinates": 0, "cpu_seconds": 0.0}  # arrays are no fields that == can compare
        assert replace(theirs, **alone) == replace(mine, **alone)
    assert there.optimum.objective == here.optimum.objective
    assert there.sensitivity == here.sensitivity
    files = [sorted((tmp_path / alone).glob("designs-*.bin")) for alone in ("True", "False")]
    mine, theirs = ({file.name: file.read_bytes() for file in own} for own in files)
    assert mine and theirs == mine  # what is kept of a search goes on by whom it may


@dataclass(frozen=True)
class InterruptedPool:
    """A pool whose tasks of one kind are interrupted, as by a Ctrl-C, and that says so as a verb does."""

    pool: ByExecutor
    task: str
    stop: Event = field(default_factory=Event)

    @property
    def cost(self) -> RunCost:
        return self.pool.cost

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        if function.__name__ == self.task:
            self.stop.set()
            return self.pool.run(interrupted, None, items)
        return self.pool.run(function, shared, items)


def interrupted(_shared: None, _item: Any) -> None:
    raise KeyboardInterrupt


@pytest.mark.parametrize("task", ["_assess", "_linearized_nodes", "_walked", "_confirmed_design"])
def test_an_interrupted_optimization_of_a_single_start_gives_the_best_so_far(
    pair, compliances, pool, task, monkeypatch
):
    """In its sample, in its walks, at nodes of one design, and in the analyses behind them."""
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.0)
    variables = [DesignVariable(f"{gear}.profile_crowning", 0.0, 2e-5) for gear in ("pinion", "wheel")]
    search = Search(SequentialLinearProgramming(sample=4), evaluations=20, positions=16, exploration=8)
    request = design_request(pair, [100.0], variables, SCATTER, search=search, map_torques=[200.0], **DRAFT)
    workers = InterruptedPool(ByExecutor(pool.executor), task)
    best = optimize(request, Run(workers=workers, cache=compliances), cancel=workers.stop.is_set)
    assert workers.stop.is_set()
    (run,) = best.runs
    assert (run.ended is Ended.CANCELLED) is (task != "_confirmed_design")
    assert ("interrupted" in best.reason) is (task != "_confirmed_design")
    assert best.optimum.objective.value <= best.start.objective.value


def test_a_failing_task_fails_the_whole(pool):
    for workers in (InProcess(), pool):
        with pytest.raises(ZeroDivisionError):
            list(workers.run(divided, 1.0, [2.0, 0.0, 4.0]))
        assert list(workers.run(divided, 1.0, [2.0, 4.0])) == [0.5, 0.25]


def divided(shared: float, item: float) -> float:
    return shared / item


def test_what_tasks_share_is_packed_once_and_passed_by_a_file(monkeypatch):
    packed: list[int] = []
    of = Packed.of

    def counted(shared):
        packed.append(id(shared))
        return of(shared)

    monkeypatch.setattr(Packed, "of", counted)
    with ThreadPoolExecutor(1) as executor:
        workers = ByExecutor(executor)
        many = [np.full(100_000, float(k)) for k in range(4)]
        for shared in (many[0], *many, many[3]):
            (found,) = workers.run(np.add, shared, [1.0])
            np.testing.assert_array_equal(found, shared + 1.0)
        folder = workers._folder.path
        assert packed == [id(shared) for shared in many]
        assert len(list(folder.iterdir())) == 2  # the last ones
        assert workers.cost.tasks == 6
    del workers
    gc.collect()
    assert not folder.exists()


def test_a_pool_that_loses_a_process_says_so(pool):
    """Nothing can be given to it any more: the last test of the pool."""
    with pytest.raises(WorkersLost, match=r"ended during the run.*: 0 of 2 tasks were done"):
        list(pool.run(end, os.getpid(), [0, 0]))
    with pytest.raises(WorkersLost, match="0 of 1 tasks were done"):
        list(pool.run(divided, 1.0, [2.0]))


def end(caller: int, _: int) -> None:
    """End this process, as the system does that has no memory left."""
    if os.getpid() != caller:
        os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize(
    ("content", "reason"),
    [(None, "No such file"), ("{", "Expecting"), ("[]", "not one that"), ('{"address": 5}', "not one that")],
)
def test_a_scheduler_that_is_not_there_is_named(tmp_path, content, reason):
    pytest.importorskip("distributed", reason="the extra dask is not installed")
    file = tmp_path / "scheduler.json"
    if content is not None:
        file.write_text(content, "utf-8")
    with pytest.raises(WorkersLost, match=rf"answers at .*scheduler.json: .*{reason}"):
        dask_workers(str(file))


def test_an_address_that_is_none_is_refused_with_what_to_start():
    pytest.importorskip("distributed", reason="the extra dask is not installed")
    refused = pytest.raises(BadInput, match=r"--scheduler.*dask worker ADDRESS")
    with refused, open_executor(scheduler="nowhere://8786"):
        raise AssertionError


def test_workers_are_of_this_machine_or_of_a_cluster():
    refused = pytest.raises(BadInput, match=r"--workers.*left out with --scheduler")
    with refused, open_executor(2, "tcp://host:8786"):
        raise AssertionError


ASKED: dict[str, Any] = {"torques": [60.0, 150.0], "level": "draft", "positions": 24, "pitches": 1}


class Interrupted(Exception):
    """What a killed process does not raise; the test goes on."""


@dataclass(frozen=True)
class Here:
    """Workers of this process that count their tasks, and stop for good after so many."""

    maximum: int = 1_000_000
    cost: RunCost = field(default_factory=RunCost)
    tasks: list[str] = field(default_factory=list)

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        for item in items:
            if len(self.tasks) == self.maximum:
                raise Interrupted
            self.tasks.append(function.__name__)
            yield function(shared, item)


@pytest.fixture(autouse=True)
def small_tasks(monkeypatch):
    """Cut small tables as large ones are."""
    monkeypatch.setattr(contact_lines, "TASK_SECONDS", 0.005)
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.0)


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


def full_pair(crowning: float = 4e-6) -> GearPair:
    """Return a pair with everything that a task can hold."""
    deviation = PitchDeviation(tuple(np.linspace(0.0, 4e-6, 20)))
    modified = FlankModification(tip_relief=8e-6, tip_relief_length=2e-3, helix_crowning=crowning)
    plain: dict[str, Any] = {"teeth": 20, "normal_module": 4e-3, "face_width": 20e-3, "bore_diameter": 40e-3}
    first = Gear(**plain, helix_angle=radians(15), modification=modified, pitch_deviation=deviation)
    shaft = Shaft(length=0.2, diameter=0.03, position=0.1)
    return GearPair(first, Gear(**plain, helix_angle=-radians(15)), shafts=(shaft, shaft))


@pytest.mark.law
def test_an_interrupted_table_goes_on_where_it_was(cache, tmp_path):
    whole = analyze(full_pair(), **ASKED, cache=cache)
    first = Here(maximum=5)
    with pytest.raises(Interrupted):
        analyze(full_pair(), **ASKED, cache=cache, workers=Remembering(first, tmp_path, "1"))
    second, third = Here(), Here()
    for workers in (second, third):
        found = analyze(full_pair(), **ASKED, cache=cache, workers=Remembering(workers, tmp_path, "1"))
        for name in found.__dataclass_fields__:
            if isinstance(getattr(whole, name), np.ndarray):
                np.testing.assert_array_equal(getattr(found, name), getattr(whole, name), err_msg=name)
    alone = Here()
    analyze(full_pair(), **ASKED, cache=cache, workers=alone)
    assert len(second.tasks) == len(alone.tasks) - 5 > 5
    assert not third.tasks


def test_another_question_takes_nothing(cache, tmp_path):
    asked = {**ASKED, "positions": 24, "cache": cache, "receipt": "minimal"}
    analyze(full_pair(), **asked)  # condenses the gears, which is a task, too
    counts = []
    for crowning, version in ((4e-6, "1"), (4e-6, "1"), (4.0000001e-6, "1"), (4e-6, "2")):
        workers = Here()
        analyze(full_pair(crowning), **asked, workers=Remembering(workers, tmp_path, version))
        counts.append(len(workers.tasks))
    assert counts[0] > 2 and counts == [counts[0], 0, counts[0], counts[0]]


def test_a_damaged_file_is_made_again(tmp_path):
    assert list(Remembering(Here(), tmp_path, "1").run(divided, 1.0, [2.0, 4.0])) == [0.5, 0.25]
    for file, content in zip(sorted(tmp_path.iterdir()), (b"", b"x" * 99), strict=True):
        file.write_bytes(content)
    workers = Here()
    assert list(Remembering(workers, tmp_path, "1").run(divided, 1.0, [2.0, 4.0])) == [0.5, 0.25]
    assert len(workers.tasks) == 2


def test_what_nobody_can_tell_apart_is_not_kept(tmp_path):
    assert list(Remembering(Here(), tmp_path, "1").run(named, object(), [2.0])) == ["2.0"]
    assert list(tmp_path.iterdir()) == []


def named(shared: object, item: float) -> str:
    return str(item)


class Kind(Enum):
    """Two kinds."""

    ONE = 1
    TWO = 2


@dataclass(frozen=True)
class Thing:
    """Something with all sorts of fields."""

    size: float = 1.0
    values: Any = None
    seconds: float = 0.0


def test_content_decides_and_how_it_came_does_not():
    grid = np.arange(6.0).reshape(2, 3)
    one = Thing(1.0, (grid, "a", None, Kind.ONE, {"b": 1}))
    assert content_digest(one) == content_digest(Thing(1.0, (grid.copy(), "a", None, Kind.ONE, {"b": 1})))
    assert content_digest(one) == content_digest(replace(one, seconds=9.0))
    others = [
        replace(one, size=np.nextafter(1.0, 2.0)),
        replace(one, values=(grid.T.copy().T, "a", None, Kind.ONE, {"b": 1})),  # laid out otherwise
        replace(one, values=(grid.reshape(3, 2), "a", None, Kind.ONE, {"b": 1})),
        replace(one, values=(grid, "a", None, Kind.TWO, {"b": 1})),
        replace(one, values=(grid, "a", None, Kind.ONE, {"c": 1})),
        replace(one, values=(grid, "a", 0, Kind.ONE, {"b": 1})),
        replace(one, values=((grid, "a"), None, Kind.ONE, {"b": 1})),
    ]
    assert len({content_digest(each) for each in [one, *others]}) == len(others) + 1


DEAR = 1000.0


@dataclass(frozen=True)
class DearWorkers:
    """Others, who take 1000 CPU s for every task."""

    cost: RunCost = field(default_factory=RunCost)

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        for item in items:
            task = TaskResult(function(shared, item), DEAR, 0)
            self.cost.add(task)
            yield task.result


def test_searches_by_workers_are_in_the_cost_of_an_optimization():
    relief = DesignVariable("pinion.tip_relief", 0.0, 60e-6)
    search = Search(NelderMead(), evaluations=4, positions=16, exploration=8, starts=2)
    workers = DearWorkers()
    request = design_request(LONG_RELIEFS, [100.0], (relief,), search=search, map_torques=[100.0], **DRAFT)
    result = optimize(request, Run(workers))
    assert workers.cost.tasks == 4  # two starts; the first design and the best are analyzed
    assert 4.0 * DEAR < result.cost["cpu_seconds"] < 5.0 * DEAR
    assert result.cost["stages"]["search"]["cpu_seconds"] > 2.0 * DEAR


def test_samples_by_workers_are_in_the_cost_of_a_tolerance_study():
    workers, slope = DearWorkers(), Tolerances(0.0, {"pinion.profile_slope": 10e-6})
    sampling = Sampling(samples=20, seed=3, positions=16)
    result = scatter(PAIR, [100.0], slope, sampling, AnalysisOptions(**DRAFT), Run(workers))
    assert result.cost["cpu_seconds"] > workers.cost.cpu_seconds >= DEAR
