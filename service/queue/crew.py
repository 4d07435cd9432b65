"""The executors of jobs: children of this machine, or tasks of a Dask scheduler."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import structlog

from host.children.launcher import Launcher
from service.queue.cluster import Cluster, Task
from service.settings import MIN_MEMORY_MB, Settings
from service.worker.order import WorkOrder
from service.worker.usage import machine_memory_mb
from service.worker.worker import WORK, Worker

logger = structlog.get_logger(__name__)
Run: TypeAlias = Worker | Task
"""Work on one order."""


class Children:
    """Child processes of this one, `settings.workers` at a time."""

    keeps = False  # work ends with the server

    def __init__(self, settings: Settings, modules: Iterable[str]) -> None:
        self.maximum = settings.workers
        self._memory_mb = max(MIN_MEMORY_MB, machine_memory_mb() // settings.workers)
        log = settings.data_directory / "log" / "warm.log"
        self._launcher = Launcher(WORK, modules, log, logger.warning)

    def start(self, _notify: Callable[[], None]) -> None:
        """Let children be launched; the first one starts the warm process."""
        self._launcher.open()

    def begin(self, order: WorkOrder, _name: str, log: Path) -> Worker:
        """Start or fork a child; raises `OSError`: the system can do neither."""
        memory_mb = order.memory_limit_mb or self._memory_mb
        return Worker(replace(order, memory_limit_mb=memory_mb), log, self._launcher.launch)

    def hurry(self) -> None:
        """Finish at once the starts in progress, since the scheduler stops."""
        self._launcher.hurry()

    def close(self) -> None:
        """End the warm process; no child is launched until the next start."""
        self._launcher.close()


Crew: TypeAlias = Children | Cluster
"""Starters of work on orders. If `keeps` is true, work outlives the server, and its name finds it again."""
