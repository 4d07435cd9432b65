"""The cluster that a benchmark starts: small, with the same results, and gone after a failure."""

import subprocess
from types import SimpleNamespace

import pytest

from benchmarks import cluster_rate

pytest.importorskip("distributed", reason="the extra dask is not installed")


@pytest.fixture
def processes(monkeypatch):
    """Collect the processes that are started."""
    processes: list[subprocess.Popen[bytes]] = []

    def noted(*words, **options):
        processes.append(subprocess.Popen(*words, **options))
        return processes[-1]

    monkeypatch.setattr(cluster_rate, "subprocess", SimpleNamespace(**vars(subprocess) | {"Popen": noted}))
    return processes


def test_a_rate_has_the_time_of_all_and_nothing_stays(processes, monkeypatch):
    monkeypatch.setattr(cluster_rate, "_TASKS", 20)
    monkeypatch.setattr(cluster_rate, "_TASK_S", 0.01)
    rate = cluster_rate.measured(2)
    assert rate.scheduler > 0.0 and rate.caller > 0.0 and rate.wall >= 0.1
    assert len(processes) == 2 and None not in [process.poll() for process in processes]


def test_workers_that_do_not_come_are_not_waited_for(processes, monkeypatch):
    monkeypatch.setattr(cluster_rate, "_WORKERS", "raise SystemExit(1)")
    with pytest.raises(RuntimeError, match="did not start"):
        cluster_rate.measured(2)
    assert len(processes) == 2 and None not in [process.poll() for process in processes]
