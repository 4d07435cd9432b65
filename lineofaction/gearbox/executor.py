"""The executor of a study: this process, processes of this machine, or a Dask scheduler."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from host.extras import MissingExtra
from lineofaction.gearbox.problems import BadInput
from model_studies.workers import InProcess, Workers, WorkersLost, dask_workers, local_processes


@contextmanager
def open_executor(processes: int = 1, scheduler: str | None = None) -> Iterator[Workers]:
    """Provide the workers of a study, and end the workers of this machine at the end.

    Parameters
    ----------
    processes : int
        Number of processes of this machine.
    scheduler : str, optional
        Address of a Dask scheduler, or the file to which the scheduler wrote it.

    Raises `BadInput`: both are given, or nobody answers at the address.
    """
    if scheduler is not None and processes != 1:
        bound = "left out with --scheduler or LOA_SCHEDULER"
        raise BadInput.of("--workers", processes, bound, "A cluster has its own.")
    if scheduler is not None:
        with _connected_workers(scheduler) as cluster:
            yield cluster
    elif processes == 1:
        yield InProcess()
    else:
        with local_processes(processes) as pool:
            yield pool


@contextmanager
def _connected_workers(scheduler: str) -> Iterator[Workers]:
    try:
        cluster = dask_workers(scheduler)
    except MissingExtra as error:
        raise BadInput.of("--scheduler", scheduler, "left out without the extra dask", f"{error}.") from None
    except WorkersLost as error:
        bound = "the address of a running Dask scheduler, such as tcp://host:8786, or its file"
        remedy = f"{error} Start one: dask scheduler; and workers: dask worker ADDRESS --nthreads 1"
        raise BadInput.of("--scheduler", scheduler, bound, remedy) from None
    with cluster.client:
        yield cluster
