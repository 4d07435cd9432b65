"""The worker process: one order in, progress and one outcome out, then the end.

Started as ``python -m service.worker.child DESCRIPTOR``, or forked, in a session of its own. The order is
the first frame on standard input, which then stays open. When it closes, the service is gone: then the whole
process group (gmsh's process included) is killed. Progress and outcome are frames on DESCRIPTOR, with bodies
of JSON. Standard error is the log.
"""

from __future__ import annotations

import importlib
import logging
import os
import shutil
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, BinaryIO

from fe_contact.cache_reads import COMPLIANCE_READS
from host import cpu_seconds, keep_freed_memory, kill_process_group, lock, lower_priority, peak_memory
from host.children.frames import Frame, read_frame
from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import ServiceError
from service.worker.order import Product, WorkOrder
from service.worker.usage import BYTES_PER_MB, begin_work, hold_to, machine_memory_mb, no_space

_NICENESS = 10
_SHORTEST_INTERVAL_S = 0.1
stamp = on_demand("lineofaction.gearbox.result_files:stamp")
translated = on_demand("lineofaction.gearbox.convert.errors:translated")
warnings_of_case = on_demand("service.worker.expectations:warnings_of_case")


def work(descriptor: int) -> None:
    """Run one order; messages go to the descriptor."""
    begin_work()
    keep_freed_memory(to_the_end=True)
    orders = os.fdopen(0, "rb", closefd=False)
    order = _order(orders)
    threading.Thread(target=_end_with, args=(orders,), daemon=True).start()
    lock(os.open(order.workspace, os.O_RDONLY), wait=True)  # never closed: locked until the process ends
    # temporary files are below the workspace, which the service removes however this process ends
    drafts = order.workspace / "drafts"
    shutil.rmtree(drafts, ignore_errors=True)  # of an attempt that was killed
    drafts.mkdir()
    _unlink_stored(order.workspace)
    os.environ["TMPDIR"] = tempfile.tempdir = str(drafts)
    lower_priority(_NICENESS)
    if order.memory_limit_mb is not None:
        hold_to(order.memory_limit_mb)
    with os.fdopen(descriptor, "wb") as stream:
        channel = _Channel(stream)
        logging.getLogger("service").addHandler(_WarningHandler(channel))
        channel.send("begun", True)  # from now on the work is to blame if the process dies
        reads_before = replace(COMPLIANCE_READS)  # a forked child begins with the counts of its parent
        outcome = _outcome(order, _Reporter(channel))
        reads = {
            "hits": COMPLIANCE_READS.hits - reads_before.hits,
            "misses": COMPLIANCE_READS.misses - reads_before.misses,
        }
        peak_mb = peak_memory() / BYTES_PER_MB
        channel.send("outcome", outcome | {"peak_mb": peak_mb, "compliance_reads": reads})


def _unlink_stored(workspace: Path) -> None:
    """Remove files of the workspace that are second names (hard links) of stored results.

    A service that is killed between storing a result and noting it leaves such a name. The next attempt would
    write through it into the stored file.
    """
    for file in workspace.rglob("*"):
        if file.is_file() and file.stat().st_nlink > 1:
            file.unlink()


def _order(orders: BinaryIO) -> WorkOrder:
    """Wait for the order."""
    frame = read_frame(orders)
    if frame is None:
        sys.exit("The service closed the channel before it gave an order.")
    return WorkOrder.from_line(frame.body)


def _end_with(orders: BinaryIO) -> None:
    """Kill the process group when the service is gone."""
    orders.read(1)  # returns when the service closes its end, since no further order comes
    kill_process_group()


class _Channel:
    """Sends messages to the service, one at a time, for all threads of the process."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream, self._sending = stream, threading.Lock()

    def send(self, kind: str, content: Any) -> None:
        """Send a message as JSON."""
        with self._sending:
            Frame.of_json(kind, content).write(self._stream)


class _WarningHandler(logging.Handler):
    """Passes warnings on to the log of the service."""

    def __init__(self, channel: _Channel) -> None:
        super().__init__(logging.WARNING)
        self._channel = channel

    def emit(self, record: logging.LogRecord) -> None:
        self._channel.send("warning", record.getMessage())


class _Reporter:
    """Progress of the work, decimated in time; stages' starts and ends always pass."""

    def __init__(self, channel: _Channel) -> None:
        self._channel, self._stage, self._sent = channel, "", 0.0

    def __call__(self, stage: str, fraction: float, total: float | None = None, /) -> None:
        """Report the fraction done of a stage, and of the whole work if that is known."""
        instant = time.monotonic()
        recent = instant - self._sent < _SHORTEST_INTERVAL_S
        if stage == self._stage and recent and fraction < 1.0:
            return
        self._stage, self._sent = stage, instant
        step = {"stage": stage, "fraction": min(max(float(fraction), 0.0), 1.0), "whole": total}
        self._channel.send("step", step | {"at": time.time(), "cpu_s": cpu_seconds()})


def _outcome(order: WorkOrder, progress: _Reporter) -> dict[str, Any]:
    """Do the work; an exception becomes an outcome, whose text shows only errors meant for callers."""
    try:
        module, _, name = order.entry.partition(":")
        products: tuple[Product, ...] = getattr(importlib.import_module(module), name)(order, progress)
        stamp_products(order, products)
    except MemoryError:
        limit = order.memory_limit_mb or machine_memory_mb()
        text = f"The computation ran out of memory: it may have {limit} MB (LOA_MEMORY_LIMIT_MB). Select a "
        text += "coarser level or fewer positions, or start the service with a higher limit."
        return {"failure": text}
    except Exception as error:  # noqa: BLE001 (a defect is logged by its traceback and reported by number)
        if isinstance(error, OSError) and (full := no_space(error)):
            return {"failure": full}
        known = error if isinstance(error, ServiceError) else translated(error)
        if known is None:
            traceback.print_exc(file=sys.stderr)
            return {"failure": "unexpected", "unexpected": True}
        return {"failure": str(known), "faults": [fault.as_json() for fault in known.faults]}
    return {"products": [asdict(product) | {"file": str(product.file)} for product in products]}


def stamp_products(order: WorkOrder, products: Sequence[Product]) -> None:
    """Write the warnings of the inputs into the file of each product; a database has them already."""
    others = any(product.kind != "database" for product in products)
    case = list(warnings_of_case(order.inputs["case"])) if others and "case" in order.inputs else None
    for product in products:
        of_case = None if product.kind == "database" else case
        if product.warnings is not None or of_case is not None:
            warnings = (*(of_case or ()), *(product.warnings or ()))
            stamp(product.file, list({warning["message"]: warning for warning in warnings}.values()))


if __name__ == "__main__":
    work(int(sys.argv[1]))
