"""A worker whose service is killed without warning ends with all its children."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest
from own_process import python
from running_service import PATIENCE_S, lives, until

from service.worker.order import WorkOrder
from service.worker.worker import Worker

SERVICE = """
import sys
from pathlib import Path
from own_process import python
from running_service import bench
from service_fakes import REGISTRY
machine = bench(Path(sys.argv[1]), REGISTRY)
machine.scheduler.start()
machine.submit(mode="hang")
machine.scheduler._thread.join()
"""


def test_kill_minus_nine_leaves_no_orphan(tmp_path: Path) -> None:
    service = python("-c", SERVICE, tmp_path, stdout=None)
    try:
        until(lambda: any(f.read_text() for f in tmp_path.glob("grandchild_*")))
        sleeper = int(next(tmp_path.glob("grandchild_*")).read_text())
        child = int(next(tmp_path.glob("started_*")).read_text().split()[0])
        assert lives(sleeper) and lives(child)
    finally:
        os.kill(service.pid, signal.SIGKILL)
        service.wait()
    until(lambda: not lives(sleeper) and not lives(child))


@pytest.mark.parametrize(("granted_s", "renewed_s"), [(-1.0, None), (PATIENCE_S, -1.0)])
def test_a_worker_ends_at_the_end_of_its_lease_however_late_it_started(
    tmp_path: Path, granted_s: float, renewed_s: float | None
) -> None:
    """It counted from when it had read the order: a slow start let it outlive a lease that nobody renewed."""
    inputs = {"wish": {"mode": "hang"}}
    now = time.monotonic()
    order = WorkOrder(
        "service_fake_work:work", inputs, "a" * 64, tmp_path, tmp_path, lease_until=now + granted_s
    )
    worker = Worker(order, tmp_path / "log")
    if renewed_s is not None:
        worker.beat(now + renewed_s)
    until(lambda: worker.listen()[1])
    outcome = worker.finish()
    assert outcome.died and "SIGKILL" in outcome.failure
