"""The same bits whoever does the work: here or in a pool (on a cluster: `tests/flow`)."""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from analysis_requests import design_request

from fe_contact import Gear, GearPair
from fe_contact.errors import InputError, WorkersLost
from fe_contact.microgeometry.optimize import optimize
from fe_contact.microgeometry.search import NelderMead, Search
from fe_contact.microgeometry.tolerance_study import Sampling, Tolerances, ToleranceStudy, scatter
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.options import AnalysisOptions, Run
from fe_contact.workers import ByExecutor, InProcess, Workers, dask_workers
from fe_contact.workers.executor import Packed

DRAFT: dict[str, Any] = {"level": "draft", "model": "plane_strain"}
SLOPES = Tolerances(0.0, {"pinion.profile_slope": 10e-6, "wheel.profile_slope": 5e-6})


@pytest.fixture(scope="module")
def compliances(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("compliances")


@pytest.fixture(scope="module")
def pair() -> GearPair:
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    return GearPair(gear, gear, 80e-3)


@pytest.fixture(scope="module")
def local(pair: GearPair, compliances: Path) -> ToleranceStudy:
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
def pool() -> Iterator[ByExecutor]:
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as executor:
        yield ByExecutor(executor)


@pytest.mark.law
def test_a_pool_of_processes_gives_the_same_bits(
    pair: GearPair, compliances: Path, local: ToleranceStudy, pool: ByExecutor
) -> None:
    shared = study(pair, compliances, pool)
    np.testing.assert_array_equal(shared.peak_to_peak, local.peak_to_peak)


def test_starts_searched_in_a_pool_find_the_same_designs(
    pair: GearPair, compliances: Path, pool: ByExecutor
) -> None:
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


def test_a_failing_task_fails_the_whole(pool: ByExecutor) -> None:
    for workers in (InProcess(), pool):
        with pytest.raises(ZeroDivisionError):
            list(workers.run(divided, 1.0, [2.0, 0.0, 4.0]))
        assert list(workers.run(divided, 1.0, [2.0, 4.0])) == [0.5, 0.25]


def divided(shared: float, item: float) -> float:
    return shared / item


def test_what_tasks_share_is_packed_once_and_passed_by_a_file(monkeypatch: pytest.MonkeyPatch) -> None:
    packed: list[int] = []
    of = Packed.of

    def counted(shared: object) -> Packed:
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


def test_a_pool_that_loses_a_process_says_so(pool: ByExecutor) -> None:
    """Nothing can be given to it any more: the last test of the pool."""
    with pytest.raises(WorkersLost, match=r"ended during the run.*: 0 of 2 tasks were done"):
        list(pool.run(end, os.getpid(), [0, 0]))
    with pytest.raises(WorkersLost, match="0 of 1 tasks were done"):
        list(pool.run(divided, 1.0, [2.0]))


def end(caller: int, _: int) -> None:
    """End this process, as the system does that has no memory left."""
    if os.getpid() != caller:
        os.kill(os.getpid(), signal.SIGKILL)


def test_a_scheduler_that_is_not_there_is_named() -> None:
    pytest.importorskip("distributed", reason="the extra dask is not installed")
    with pytest.raises(InputError) as caught:
        dask_workers("nowhere")
    assert caught.value.field == "dask"
