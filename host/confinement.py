"""What a process that reads foreign bytes gives up before it reads them.

Whatever a file makes its reader do, a confined process opens no file but those of Python and of its own
folder, makes no connection, and ends at its limits of memory, CPU time and size of files. What the system
lacks is missing by name: `missing_protections`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from host import landlock, socket_filter
from host.extras import Unavailable

# Limits on what processes may take: POSIX systems alone have them, elsewhere each raises `Unavailable`.


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


FILES, NETWORK, LIMITS = "files (Landlock)", "network (seccomp)", "memory and CPU time"
_ROOT = Path(__file__).resolve().parents[1]
_SYSTEM = ("/usr", "/lib", "/lib64", "/etc/ld.so.cache", "/etc/localtime", "/dev/null", "/dev/urandom")
_MB = 1 << 20


@dataclass(frozen=True)
class Limits:
    """What a process that reads foreign bytes may take.

    Attributes
    ----------
    memory_mb : int or None
        Private memory that it may write, MB; None: as much as the process that started it.
    cpu_seconds : int
        At their end the system kills it.
    file_bytes : int
        Size of a file that it writes.
    open_files : int
    """

    memory_mb: int | None = 512
    cpu_seconds: int = 10
    file_bytes: int = 256_000_000
    open_files: int = 64


READING = Limits()
"""The limits of every reader whose work is reading alone."""


def missing_protections() -> tuple[str, ...]:
    """Return the protections that this system lacks, by name."""
    present = {
        FILES: landlock.version() > 0,
        NETWORK: socket_filter.available(),
        LIMITS: sys.platform == "linux",
    }
    return tuple(name for name, has in present.items() if not has)


def confine(folder: Path, limits: Limits = READING) -> None:
    """Give up all that reading does not need; before other threads exist, and for good.

    Parameters
    ----------
    folder : Path
        Where the process reads its input and writes; everything beneath it is its own.
    limits : Limits

    Raises
    ------
    OSError
        The system has a protection and refuses it.
    """
    missing = missing_protections()
    if LIMITS not in missing:
        _limit(limits)
    if FILES not in missing:
        landlock.restrict(_readable(), folder)
    if NETWORK not in missing:
        socket_filter.refuse_sockets()


def _limit(limits: Limits) -> None:
    if sys.platform == "win32":
        raise Unavailable("Limits of processes")
    import resource  # noqa: PLC0415 (POSIX alone)

    if limits.memory_mb is not None:
        limit_memory(limits.memory_mb * _MB)
    most = {
        resource.RLIMIT_CPU: (
            limits.cpu_seconds,
            limits.cpu_seconds + 1,
        ),  # the first says why
        resource.RLIMIT_FSIZE: (limits.file_bytes, limits.file_bytes),
        resource.RLIMIT_NOFILE: (limits.open_files, limits.open_files),
        resource.RLIMIT_CORE: (0, 0),
    }
    for kind, values in most.items():
        _, hard = resource.getrlimit(kind)
        soft, last = values if hard == resource.RLIM_INFINITY else (min(value, hard) for value in values)
        resource.setrlimit(kind, (soft, last))


def _readable() -> Iterator[Path]:
    """Yield where Python and its modules are.

    Of a folder of modules outside Python's own, which may be anybody's, that is the packages and modules.
    """
    own = [Path(folder).resolve() for folder in (sys.prefix, sys.base_prefix, *_SYSTEM)]
    yield from own
    for entry in filter(None, (str(_ROOT), *sys.path)):
        folder = Path(entry).resolve()
        if folder.is_file() or any(folder.is_relative_to(part) for part in own):
            yield folder
        elif folder.is_dir():
            yield from (path.parent for path in folder.glob("*/__init__.py"))
            yield from folder.glob("*.py")
