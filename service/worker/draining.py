"""Draining of a Dask worker on SIGTERM: it finishes its job and hands its result over.

Dask itself ends a worker at once. Started as ``dask worker --no-nanny --preload service.worker.draining``, a
worker begins no further task, finishes those in progress, waits until their results have been moved, and
ends. A second SIGTERM ends it at once. Its supervisor must wait as long as a job may take
(`terminationGracePeriodSeconds`).
"""

from __future__ import annotations

import asyncio
import signal
import time
from contextlib import suppress
from typing import TYPE_CHECKING

import structlog

if TYPE_CHECKING:
    from distributed import Worker

JOBS = "loa-"
"""Beginning of the keys of jobs, as `service.queue.cluster` sets it."""
_LOOK_S = 0.1
_FETCH_S, _MOVE_S = 30.0, 30.0
"""Seconds for which results wait for the server that fetches them, and seconds left for their move to other
workers."""
logger = structlog.get_logger(__name__)


async def dask_setup(worker: Worker) -> None:
    """Let SIGTERM drain a worker; Dask calls this when it has started, after it has set its handlers."""
    loop, draining = asyncio.get_running_loop(), list[asyncio.Task[None]]()

    def drain() -> None:
        loop.remove_signal_handler(signal.SIGTERM)  # a second one ends the process
        draining.append(loop.create_task(_drain(worker)))

    loop.add_signal_handler(signal.SIGTERM, drain)


async def _drain(worker: Worker) -> None:
    """Finish the job in progress, and close."""
    from distributed.core import Status  # noqa: PLC0415 (an extra)

    logger.info("worker drains", worker=worker.address, tasks=len(_in_work(worker)))
    worker.status = Status.closing_gracefully  # the scheduler sends it no more
    while _in_work(worker):
        await asyncio.sleep(_LOOK_S)
    end = time.monotonic() + _FETCH_S
    while any(str(key).startswith(JOBS) for key in worker.data) and time.monotonic() < end:
        await asyncio.sleep(_LOOK_S)
    with suppress(OSError, TimeoutError):  # a scheduler that is gone has nothing to move
        leave = worker.scheduler.retire_workers(workers=[worker.address], close_workers=False, remove=True)
        await asyncio.wait_for(leave, _MOVE_S)
    await worker.close(reason="drained")


def _in_work(worker: Worker) -> set[object]:
    """Return the tasks that a worker does now."""
    return {*worker.state.executing, *worker.state.long_running}
