"""The workers of a study: those of a job, or of the command line."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context

from fe_contact.workers import ByExecutor, InProcess, Workers, dask_workers
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.problems import BadInput


@dataclass(frozen=True)
class ExecutorChoice:
    """A number of processes here, or the address of a Dask scheduler."""

    workers: int = 1
    dask: str | None = None


@contextmanager
def open_executor(choice: ExecutorChoice) -> Iterator[Workers]:
    """Provide the workers, and send those of this machine home at the end.

    Raises
    ------
    BadInput
        Both are given, or nobody answers at the address.
    """
    if choice.dask is not None and choice.workers != 1:
        raise BadInput.of("--workers", choice.workers, "left out with --dask", "The cluster has its own.")
    if choice.dask is not None:
        with boundary_errors():
            cluster = dask_workers(choice.dask)
        with cluster.client:
            yield cluster
    elif choice.workers == 1:
        yield InProcess()
    else:
        # spawn: compiled code and numerical libraries do not survive a fork
        with ProcessPoolExecutor(choice.workers, mp_context=get_context("spawn")) as executor:
            yield ByExecutor(executor)
