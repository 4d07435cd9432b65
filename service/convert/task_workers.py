"""Who does the tasks of a study: a job, or one started from the command line."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context

from fe_contact.workers import ByExecutor, InProcess, Workers, dask_workers
from service.convert.case import boundary_errors
from service.problems import BadInput


@dataclass(frozen=True)
class Hands:
    """A number of processes here, or the address of a Dask scheduler."""

    workers: int = 1
    dask: str | None = None


@contextmanager
def working_hands(hands: Hands) -> Iterator[Workers]:
    """Provide the workers, and send those of this machine home at the end.

    Raises
    ------
    BadInput
        Both are given, or nobody answers at the address.
    """
    if hands.dask is not None and hands.workers != 1:
        raise BadInput.of("--workers", hands.workers, "left out with --dask", "The cluster has its own.")
    if hands.dask is not None:
        with boundary_errors():
            cluster = dask_workers(hands.dask)
        with cluster.client:
            yield cluster
    elif hands.workers == 1:
        yield InProcess()
    else:
        # spawn: compiled code and numerical libraries do not survive a fork
        with ProcessPoolExecutor(hands.workers, mp_context=get_context("spawn")) as executor:
            yield ByExecutor(executor)
