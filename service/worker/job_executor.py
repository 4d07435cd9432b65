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
from model_studies.workers import ByDask, InProcess, OrHere, Remembering, RunCost, Workers, dask_workers
from service.version import solver_version
from service.worker.order import PARTS, WorkOrder

logger = logging.getLogger(__name__)
S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")


@contextmanager
def table_workers(order: WorkOrder) -> Iterator[Workers]:
    """Provide the workers of tables, as `cluster_of`, with their finished tasks stored until the job ends.

    An attempt after one that died finds it in the workspace. Gears are kept in the cache of the service.
    """
    with cluster_of(order) as workers:
        version = f"{solver_version()} {SOLVER_VERSION}"
        yield Remembering(workers, order.workspace / "tasks", version)


@contextmanager
def cluster_of(order: WorkOrder) -> Iterator[Workers]:
    """Provide the workers of a job: the cluster's, if the service has one, as long as it has workers.

    A job does not fail because a cluster is away: it takes longer, and gives the same bits. What the cluster
    leaves is done in this process; the log says so, with the reason, and the receipt of a table.
    """
    if order.scheduler is None:
        yield InProcess()
        return
    cluster = _WhenNeeded(order.scheduler, order.workspace / PARTS)
    try:
        yield OrHere(cluster, partial(logger.warning, "cluster away, the job goes on here: %s"))
    finally:
        for connected in cluster.connected:
            connected.client.close()  # type: ignore[no-untyped-call]


@dataclass(frozen=True)
class _WhenNeeded:
    """A cluster that the first run connects to: small jobs have none, and connecting costs a second."""

    scheduler: str
    note: Path
    cost: RunCost = field(default_factory=RunCost, compare=False)
    connected: list[ByDask] = field(default_factory=list, compare=False)

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        if not self.connected:
            self.note.touch()  # a Dask worker that waits for this job lends its thread to the parts
            self.connected.append(_connected(self.scheduler, self.cost))
        return self.connected[0].run(function, shared, items)


def _connected(scheduler: str, cost: RunCost) -> ByDask:
    return replace(dask_workers(scheduler), cost=cost)
