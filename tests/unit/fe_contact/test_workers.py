"""The same bits whoever does the work: here, in a pool, on a cluster that loses a worker in mid-run."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fe_contact import Gear, GearPair
from fe_contact.errors import InputError
from fe_contact.microgeometry import (
    DesignVariable,
    NelderMead,
    Search,
    Tolerances,
    ToleranceStudy,
    optimise,
    scatter,
)
from fe_contact.workers import ByDask, ByExecutor, InProcess, Workers, dask_workers

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


def study(pair: GearPair, compliances: Path, workers: Workers, progress: Any = None) -> ToleranceStudy:
    return scatter(
        pair, [100.0, 200.0], SLOPES, samples=200, seed=1, workers=workers, progress=progress,
        cache=compliances, **DRAFT,
    )  # fmt: skip


@pytest.fixture(scope="module")
def pool() -> Iterator[ByExecutor]:
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as executor:
        yield ByExecutor(executor)


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
        optimise(
            pair, [200.0], variables, search=search, workers=workers, map_torques=[200.0],
            cache=compliances, **DRAFT,
        )
        for workers in (InProcess(), pool)
    )  # fmt: skip
    assert [run.judged for run in there.runs] == [run.judged for run in here.runs]
    assert there.optimum.values == here.optimum.values
    assert there.optimum.objective == here.optimum.objective


def test_a_failing_task_fails_the_whole(pool: ByExecutor) -> None:
    for workers in (InProcess(), pool):
        with pytest.raises(ZeroDivisionError):
            list(workers.run(divided, 1.0, [2.0, 0.0, 4.0]))
        assert list(workers.run(divided, 1.0, [2.0, 4.0])) == [0.5, 0.25]


def divided(shared: float, item: float) -> float:
    return shared / item


@pytest.mark.filterwarnings("ignore")
def test_a_cluster_that_loses_a_worker_in_mid_run_gives_the_same_bits(
    pair: GearPair, compliances: Path, local: ToleranceStudy
) -> None:
    distributed = pytest.importorskip("distributed", reason="the extra dask is not installed")
    killed: list[int] = []
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1", memory_limit=0
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        pids = list(client.run(os.getpid).values())

        def kill(stage: str, fraction: float) -> None:
            if stage == "samples" and fraction < 0.5 and not killed:
                os.kill(pids[0], signal.SIGKILL)
                killed.append(pids[0])

        shared = study(pair, compliances, ByDask(client), kill)
        alive = set(client.run(os.getpid).values())
    assert killed and killed[0] not in alive
    np.testing.assert_array_equal(shared.peak_to_peak, local.peak_to_peak)
    assert shared.quantiles[1].value.tolist() == local.quantiles[1].value.tolist()


def test_a_scheduler_that_is_not_there_is_named() -> None:
    pytest.importorskip("distributed", reason="the extra dask is not installed")
    with pytest.raises(InputError) as caught:
        dask_workers("nowhere")
    assert caught.value.field == "dask"
