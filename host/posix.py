"""Linux and macOS."""

from __future__ import annotations

import ctypes
import fcntl
import math
import os
import resource
import sys
import time

from host.sessions import RESIDENT_UNIT, memory_figure

assert sys.platform != "win32"

_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
"""Settings of mallopt, of glibc; before version 2.35 it takes no threshold of mapped memory above 32 MiB."""
_MIB = 1 << 20


def cpu_seconds() -> float:
    """Return the CPU seconds of this process and of its finished children, the measure of a cost."""
    return time.process_time() + children_cpu_seconds()


def children_cpu_seconds() -> float:
    """Return the CPU seconds of finished children."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def peak_memory() -> int:
    """Return the most resident memory this process has had, bytes.

    The counter of getrusage begins with the peak of who started the process; Linux has another, its own.
    """
    peak = memory_figure("VmHWM")
    return RESIDENT_UNIT * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss if peak is None else peak


def children_peak_memory() -> int:
    """Return the most resident memory one of the finished children has had, bytes."""
    return RESIDENT_UNIT * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss


def physical_memory() -> int:
    """Return the memory of the machine, bytes."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def keep_freed_memory(*, to_the_end: bool = False) -> None:
    """Let this process keep up to 64 MiB that it has freed; `to_the_end`: all of it until the process ends.

    The system clears each page that a process gets, so pages that it gives back cost time when it gets them
    anew. The limit is for tasks that allocate alike again and again, no limit for a process of one
    computation. Where the C library has no such setting nothing changes.
    """
    setting = getattr(ctypes.CDLL(None), "mallopt", None)
    # 2047: the largest whole number of MiB that the setting takes
    largest_block, freed = (1024, 2047) if to_the_end else (32, 64)
    if setting is not None and setting(_MMAP_THRESHOLD, largest_block * _MIB):
        setting(_TRIM_THRESHOLD, freed * _MIB)


def max_open_files() -> float:
    """Return how many files, sockets among them, this process may have open at once; infinite: no limit."""
    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    return math.inf if soft == resource.RLIM_INFINITY else soft


def lock(file: int, *, wait: bool = False) -> None:
    """Lock an open file or folder until its descriptor is closed; the system closes that of a dead process.

    Raises `BlockingIOError`: another process has the lock, and we do not `wait`.
    """
    fcntl.flock(file, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
