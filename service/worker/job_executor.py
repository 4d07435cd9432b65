"""Executor of a job's tasks: the service's Dask cluster, or this process while the cluster is away."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TypeVar

from fe_contact.solver_version import SOLVER_VERSION
from model_studies.workers import (
    ByDask,
    InProcess,
    LocalFallback,
    Remembering,
    RunCost,
    Workers,
    dask_workers,
)
from service.version import solver_version
from service.worker.order import PARTS, WorkOrder

logger = logging.getLogger(__name__)
S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")


@contextmanager
def table_workers(order: WorkOrder) -> Iterator[Workers]:
    """Provide the workers of tables, as `cluster_of`, with their finished tasks stored until the job ends.

    The tasks are stored in the workspace of the job: after an attempt that died, the next one finds them
    there. Condensed gears are stored in the cache of the service instead.
    """
    with cluster_of(order) as workers:
        # of the service, and of the solver of contact: tasks of another version are computed again
        version = f"{solver_version()} {SOLVER_VERSION}"
        yield Remembering(workers, order.workspace / "tasks", version)


@contextmanager
def cluster_of(order: WorkOrder) -> Iterator[Workers]:
    """Provide the workers of a job: those of the cluster of the service, or else this process.

    A job does not fail because a cluster is away: it takes longer, and gives the same bits. This process does
    the tasks that the cluster has not done. The log says so, with the reason, and so does the receipt of a
    table.
    """
    if order.scheduler is None:
        yield InProcess()
        return
    cluster = _DeferredCluster(order.scheduler, order.workspace / PARTS)
    try:
        yield LocalFallback(cluster, partial(logger.warning, "cluster away, the job goes on here: %s"))
    finally:
        for connected in cluster.connected:
            connected.client.close()


@dataclass(frozen=True)
class _DeferredCluster:
    """A cluster that the first run connects to: small jobs need none, and the connection takes a second."""

    scheduler: str
    marker: Path
    """File `PARTS` of the workspace: it exists once the job gives tasks to the cluster."""
    cost: RunCost = field(default_factory=RunCost, compare=False)
    connected: list[ByDask] = field(default_factory=list, compare=False)
    """The connection, after the first run; empty before."""

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        if not self.connected:
            # A Dask worker that only waits for this job sees the file, and frees its thread for the tasks.
            self.marker.touch()
            self.connected.append(_connected_cluster(self.scheduler, self.cost))
        return self.connected[0].run(function, shared, items)


def _connected_cluster(scheduler: str, cost: RunCost) -> ByDask:
    return replace(dask_workers(scheduler), cost=cost)
