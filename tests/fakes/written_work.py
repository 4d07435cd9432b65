"""Work of processes that computes nothing: it writes a file with the kind that it is named for."""

from collections.abc import Callable
from functools import partial

import h5netcdf

import service.worker.preparations  # noqa: F401 (stamps each result: once, before workers are forked)
from lineofaction.gearbox.registry import RESULT_KINDS
from service.worker.order import Product, Progress, WorkOrder

Work = Callable[[WorkOrder, Progress], tuple[Product, ...]]


def __getattr__(name: str) -> Work:
    if name in RESULT_KINDS:
        return partial(_write, name)
    raise AttributeError(name)


def _write(kind: str, order: WorkOrder, _progress: Progress) -> tuple[Product, ...]:
    path = order.workspace / "result.nc"
    with h5netcdf.File(path, "w") as file:
        file.attrs["kind"] = kind
    return (Product(order.key, kind, path),)
