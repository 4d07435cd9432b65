"""Windows, by the standard library and psutil."""

from __future__ import annotations

import math
import os
import sys
import threading
import time
from importlib import import_module

from host.extras import Unavailable

_KILLED = 1
"""Exit code of a process that ended itself after its time."""


def cpu_seconds() -> float:
    """Return the CPU seconds of this process; those of its children are not known."""
    return time.process_time()


def children_cpu_seconds() -> float:
    """Return 0: the system does not keep the CPU time of finished children."""
    return 0.0


def peak_memory() -> int:
    """Return the most resident memory this process has had, bytes."""
    return int(import_module("psutil").Process().memory_info().peak_wset)


def children_peak_memory() -> int:
    """Return 0: the system does not keep the memory of finished children."""
    return 0


def physical_memory() -> int:
    """Return the memory of the machine, bytes."""
    return int(import_module("psutil").virtual_memory().total)


def keep_freed_memory(*, to_the_end: bool = False) -> None:
    """Do nothing: the system has no such setting."""


def max_open_files() -> float:
    """Return infinity: the system has no limit that a process can ask for."""
    return math.inf


def lock(file: int, *, wait: bool = False) -> None:
    """Lock the first byte of an open file until its descriptor is closed.

    Raises `BlockingIOError`: another process has the lock; `Unavailable`: we would `wait`: only the service
    does.
    """
    if wait or sys.platform != "win32":
        raise Unavailable("locks that are waited for" if wait else "locks on files")
    import msvcrt  # noqa: PLC0415 (Windows alone has it)

    try:
        msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
    except PermissionError as error:
        raise BlockingIOError(*error.args) from None


def end_after(seconds: int) -> None:
    """End this process after so many seconds, whatever it does then."""
    timer = threading.Timer(seconds, os._exit, (_KILLED,))
    timer.daemon = True
    timer.start()
