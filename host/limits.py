"""Limits on what processes may take: POSIX systems alone have them, elsewhere each raises `Unavailable`."""

from __future__ import annotations

import sys

from host.unavailable import Unavailable


def limit_memory(size: int) -> None:
    """Let allocations of this process fail beyond so many bytes of data; a stricter limit stays.

    The limit is RLIMIT_DATA, which Linux heeds; other systems may not.
    """
    if sys.platform == "win32":
        raise Unavailable("Limits on memory")
    import resource  # noqa: PLC0415 (POSIX alone)

    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    most = size if hard == resource.RLIM_INFINITY else min(size, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (most, hard))


def limit_file_size(pid: int, size: int) -> None:
    """Let writes of another process fail beyond so many bytes of a file; Linux alone has it."""
    if sys.platform != "linux":
        raise Unavailable("Limits on other processes", "Use Linux.")
    import resource  # noqa: PLC0415 (POSIX alone)

    resource.prlimit(pid, resource.RLIMIT_FSIZE, (size, size))
