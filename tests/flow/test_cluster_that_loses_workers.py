"""Tables and studies on a cluster whose processes are killed in mid-run: complete, equal to the last bit."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from analysis_requests import table_request
from compliance_gears import SPUR as FEW_TEETH
from compliance_gears import coarse

from fe_contact import Gear, GearPair, SteDatabase, analyze, study_sensitivity
from fe_contact.analysis.pairs import contact_lines
from fe_contact.compliance.remote_condensation import condense_remotely
from fe_contact.microgeometry.tolerance_study import Sampling, scatter
from fe_contact.microgeometry.tolerances import Tolerances
from fe_contact.options import AnalysisOptions, Run
from model_studies.workers import (
    ByDask,
    InProcess,
    LocalFallback,
    RunCost,
    Workers,
    WorkersLost,
    cluster_cached,
    dask_cluster,
    dispatch,
)

distributed = pytest.importorskip("distributed", reason="the extra dask is not installed")
pytestmark = pytest.mark.filterwarnings("ignore")

AXES = {"misalignments": [-10e-6, 25e-6], "center_distance_changes": [0.0, 80e-6]}
WORKER = ["-m", "dask", "worker", "--no-nanny", "--no-dashboard", "--nthreads", "1", "--death-timeout", "60"]


@dataclass
class Cluster:
    """A scheduler here, and workers in processes of their own that nobody starts again."""

    client: Any
    address: str
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def at_least(self, count: int) -> None:
        """Start workers until there are so many."""
        while len(self.alive) < count:
            command = [sys.executable, *WORKER, self.address]
            quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
            self.processes.append(subprocess.Popen(command, **quiet))
        self.client.wait_for_workers(count)

    @property
    def alive(self) -> list[subprocess.Popen[bytes]]:
        return [process for process in self.processes if process.poll() is None]

    def kill_busy(self, count: int) -> None:
        """Kill (SIGKILL) so many workers, first those that have tasks."""
        pids, tasks = self.client.run(os.getpid), self.client.processing()
        for address in sorted(pids, key=lambda name: -len(tasks.get(name, ())))[:count]:
            os.kill(pids[address], signal.SIGKILL)


@dataclass(frozen=True)
class Losing:
    """Workers of whom some are killed when a number of tasks of a function is done."""

    others: Workers
    kill: Callable[[], None]
    function: str
    after: int = 2
    killed: list[float] = field(default_factory=list)

    @property
    def cost(self) -> RunCost:
        return self.others.cost

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        for count, result in enumerate(self.others.run(function, shared, items), 1):
            if function.__name__ == self.function and count == self.after < len(items) and not self.killed:
                self.kill()
                self.killed.append(count / len(items))
            yield result


@pytest.fixture(scope="module")
def cluster():
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=None, host="127.0.0.1") as scheduler,
        distributed.Client(scheduler, set_as_default=False) as client,
    ):
        made = Cluster(client, scheduler.scheduler_address)
        try:
            yield made
        finally:
            for process in made.alive:
                process.kill()
            for process in made.processes:
                process.wait()


@pytest.fixture(autouse=True)
def small_tasks(monkeypatch):
    monkeypatch.setattr(contact_lines, "TASK_SECONDS", 0.01)
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.0)


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


def gear(**other: Any) -> Gear:
    plain: dict[str, Any] = {"teeth": 20, "normal_module": 4e-3, "face_width": 20e-3, "bore_diameter": 40e-3}
    return Gear(**plain | {"thickness_allowance": 60e-6} | other)


PAIR = GearPair(gear(helix_angle=radians(15)), gear(helix_angle=-radians(15)))
SPUR = GearPair(gear(), gear())


def table(cache: Path, workers: Workers = InProcess()) -> SteDatabase:  # noqa: B008 (frozen)
    asked: dict[str, Any] = {"torques": [60.0, 150.0], "level": "draft", "positions": 24, **AXES}
    return analyze(PAIR, **asked, cache=cache, workers=workers)


@pytest.fixture(scope="module")
def alone(cache):
    return table(cache)


def assert_same(one: SteDatabase, other: SteDatabase) -> None:
    for name in one.__dataclass_fields__:
        if isinstance(getattr(one, name), np.ndarray):
            np.testing.assert_array_equal(getattr(other, name), getattr(one, name), err_msg=name)


@pytest.mark.nightly
def test_a_table_of_three_workers_one_of_which_is_killed(cluster, cache, alone):
    cluster.at_least(3)
    workers = Losing(ByDask(cluster.client), lambda: cluster.kill_busy(1), "solve_block")
    assert_same(alone, table(cache, workers))
    assert workers.killed and workers.killed[0] < 0.5
    assert len(cluster.alive) == 2
    assert workers.cost.cpu_seconds > 0.0 and not workers.cost.lost


@pytest.mark.nightly
def test_a_sensitivity_sweep_of_three_workers_one_of_which_is_killed(cluster, cache):
    cluster.at_least(3)
    workers = Losing(ByDask(cluster.client), lambda: cluster.kill_busy(1), "solve_block")
    asked: dict[str, Any] = {
        "normal_forces": [2000.0], "misalignments": [20e-6], "center_distance_changes": [50e-6],
        "level": "draft", "positions": 16,
    }  # fmt: skip
    here, there = (
        study_sensitivity(PAIR, *table_request(**asked), Run(workers=who, cache=cache))
        for who in (InProcess(), workers)
    )
    assert workers.killed and len(cluster.alive) == 2
    for one, other in zip(here, there, strict=True):
        for name in ("misalignment", "center_distance_change"):
            first, second = getattr(one, name), getattr(other, name)
            assert second.peak_to_peak.tolist() == first.peak_to_peak.tolist()
            assert second.error.tolist() == first.error.tolist()


@pytest.mark.nightly
def test_a_monte_carlo_of_two_workers_one_of_which_is_killed(cluster, cache):
    cluster.at_least(2)
    slopes = Tolerances(0.0, {"pinion.profile_slope": 10e-6, "wheel.profile_slope": 5e-6})
    workers = Losing(ByDask(cluster.client), lambda: cluster.kill_busy(1), "curves_of_samples")
    here, there = (
        scatter(
            SPUR,
            [100.0, 200.0],
            slopes,
            Sampling(samples=200, seed=1),
            AnalysisOptions(level="draft", model="plane_strain"),
            Run(workers=who, cache=cache),
        )
        for who in (InProcess(), workers)
    )
    assert workers.killed and len(cluster.alive) == 1
    np.testing.assert_array_equal(there.peak_to_peak, here.peak_to_peak)
    assert there.quantiles[1].value.tolist() == here.quantiles[1].value.tolist()


@pytest.mark.law
def test_what_two_callers_want_at_once_is_done_once(cluster, tmp_path):
    cluster.at_least(1)
    links = [str(tmp_path / str(number)) for number in range(12)]
    with distributed.Client(cluster.address, set_as_default=False) as other:
        first, second, third = (
            ByDask(client).run(os.symlink, "nowhere", links)  # a second one of the same name fails
            for client in (cluster.client, other, cluster.client)
        )
        next(third)
        third.close()
        assert list(first) == list(second) == [None] * len(links)
    assert sorted(map(os.readlink, links)) == ["nowhere"] * len(links)


@pytest.mark.law
def test_a_gear_is_condensed_once_for_all_machines_and_the_oldest_one_goes(cluster, tmp_path, monkeypatch):
    cluster.at_least(2)
    monkeypatch.setattr(dask_cluster, "MAX_RESULTS", 2)
    first, second = replace(FEW_TEETH, teeth=10), FEW_TEETH

    def tasks(machine, *gears):
        """Return how many were condensed for a machine that has none of them."""
        (tmp_path / machine).mkdir()
        with distributed.Client(cluster.address, set_as_default=False) as client:
            workers = ByDask(client)
            condense_remotely(gears, [coarse(each) for each in gears], tmp_path / machine, workers)
            assert (workers.cost.cpu_seconds > 0.0) == (workers.cost.tasks > 0)
        assert len(list((tmp_path / machine).glob("compliance-*.npz"))) == len(gears)
        return workers.cost.tasks

    assert [tasks("a", first), tasks("b", first, second), tasks("c", second, first)] == [1, 1, 0]
    one, other = ({file.name: file.read_bytes() for file in (tmp_path / name).iterdir()} for name in "bc")
    assert one == other
    assert [tasks("d", replace(first, teeth=11)), tasks("e", second), tasks("f", first)] == [1, 0, 1]


def test_what_a_cluster_leaves_whose_last_worker_is_killed_is_done_here(cluster, cache, alone):
    cluster.at_least(1)
    losing = Losing(ByDask(cluster.client, patience=1.0), lambda: cluster.kill_busy(9), "solve_block")
    told: list[WorkersLost] = []
    found = table(cache, LocalFallback(losing, told.append))
    assert losing.killed and not cluster.alive
    assert_same(alone, found)
    assert len(told) == 1 and "had no worker for 1 s" in str(told[0])
    receipt = found.metadata.receipt["elsewhere"]
    assert receipt["lost"] == str(told[0]) and receipt["tasks"] >= losing.after


def test_a_cluster_without_workers_ends_the_run_and_says_so(cluster):
    cluster.kill_busy(9)
    begun = time.monotonic()
    with pytest.raises(WorkersLost, match=r"no worker for 0\.5 s: 0 of 2 tasks were done\. Start workers"):
        list(ByDask(cluster.client, patience=0.5).run(divided, 1.0, [2.0, 4.0]))
    assert time.monotonic() - begun > 0.5


@pytest.mark.nightly
def test_a_scheduler_that_goes_after_the_last_result_loses_nothing():
    scheduler = distributed.LocalCluster(n_workers=1, processes=False, dashboard_address=None)
    with distributed.Client(scheduler, set_as_default=False, timeout=5.0) as client:
        results = ByDask(client).run(kept_quotient, 1.0, [2.0, 4.0])
        assert [next(results), next(results)] == [0.5, 0.25]
        scheduler.close()
        assert list(results) == []  # and none is kept


@pytest.mark.nightly
@pytest.mark.parametrize("kept", [False, True])
def test_a_scheduler_that_goes_ends_the_run_and_says_so(kept):
    scheduler = distributed.LocalCluster(n_workers=0, dashboard_address=None, host="127.0.0.1")
    with distributed.Client(scheduler, set_as_default=False, timeout=5.0) as client:
        workers = ByDask(client)
        results = workers.run(kept_quotient if kept else divided, 1.0, [2.0])
        scheduler.close()
        with pytest.raises(WorkersLost, match="is gone: 0 of 1 tasks were done"):
            next(results)
        with pytest.raises(WorkersLost, match="is gone: 0 of 2 tasks were done"):
            workers.run(divided, 1.0, [2.0, 4.0])


def divided(shared: float, item: float) -> float:
    return shared / item


@cluster_cached
def kept_quotient(shared: float, item: float) -> float:
    return shared / item
