"""Confinement of a process before it reads foreign bytes: files, system calls and limits.

Whatever a file makes its reader do, a confined process opens no file but those of Python and of its own
folder, calls the system for what reading needs and nothing else (`host.system_calls`), and ends at its limits
of memory, CPU time and size of files. `missing_protections` names the protections that a system lacks.
"""

from __future__ import annotations

import ctypes
import errno
import signal
import sys
from contextlib import suppress
from functools import cache
from itertools import islice
from pathlib import Path

from host.extras import Unavailable
from host.landlock import checked, landlock_version, restrict
from host.reading_limits import READING, Limits
from host.system_calls import filters_calls, keep_to_reading

FILES, CALLS, LIMITS = "files (Landlock)", "system calls (seccomp)", "memory and CPU time"
_ROOT = Path(__file__).resolve().parents[1]
_SYSTEM = ("/usr", "/lib", "/lib64", "/etc/ld.so.cache", "/etc/localtime", "/dev/null", "/dev/urandom")
_MB = 1 << 20
_SIGNAL_AT_END_OF_PARENT = 1
_LIBRARIES_MB = 1024
"""Address space of libraries that are loaded later, in addition to memory, MB: scipy 130, gmsh 100."""
_STACK_MB = 64
"""gmsh asks for a stack without limit, and does not get it."""


def limit_memory(size: int) -> None:
    """Let allocations of this process fail beyond so many bytes of data; a stricter limit stays.

    The limit is RLIMIT_DATA, which Linux heeds; other systems may not.
    """
    if sys.platform == "win32":
        raise Unavailable("Limits on memory")
    import resource  # noqa: PLC0415 (POSIX alone)

    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    maximum = size if hard == resource.RLIM_INFINITY else min(size, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (maximum, hard))


def limit_file_size(pid: int, size: int) -> None:
    """Let writes of another process fail beyond so many bytes of a file; Linux alone has it."""
    if sys.platform != "linux":
        raise Unavailable("Limits on other processes", "Use Linux.")
    import resource  # noqa: PLC0415 (POSIX alone)

    resource.prlimit(pid, resource.RLIMIT_FSIZE, (size, size))


def missing_protections() -> tuple[str, ...]:
    """Return the protections that this system lacks, by name."""
    present = {
        FILES: landlock_version() > 0,
        CALLS: filters_calls(),
        LIMITS: sys.platform == "linux",
    }
    return tuple(name for name, has in present.items() if not has)


def confine(folder: Path, limits: Limits = READING) -> None:
    """Give up all that reading does not need; before other threads exist, and for good.

    `folder`: where the process reads its input and writes; it makes files in it, no folders, links or pipes.
    The process ends with the thread that started it. Raises `OSError`: the system has a protection and
    refuses it, or there are other threads, which would keep what this one gives up.
    """
    missing = missing_protections()
    if LIMITS not in missing:
        threads, addresses = _threads_and_addresses()
        if threads > 1:
            raise OSError(errno.EBUSY, f"{threads - 1} other threads of this process would not be confined")
        _limit(limits, addresses)
        checked(ctypes.CDLL(None, use_errno=True).prctl(_SIGNAL_AT_END_OF_PARENT, signal.SIGKILL))
    if FILES not in missing:
        restrict(_readable(), folder)
    if CALLS not in missing:
        keep_to_reading()


def prepare_confinement() -> None:
    """Prepare, in a process whose forks are confined, the data that are the same for all of them."""
    _readable()


def _threads_and_addresses() -> tuple[int, int]:
    """Return the number of threads and the bytes of address space of this process; 1 and 0 without /proc."""
    with suppress(OSError):
        fields = Path("/proc/self/stat").read_bytes().rpartition(b")")[2].split()
        return int(fields[17]), int(fields[20])
    return 1, 0


def _limit(limits: Limits, addresses: int) -> None:
    if sys.platform == "win32":
        raise Unavailable("Limits of processes")
    import resource  # noqa: PLC0415 (POSIX alone)

    maximum = {
        resource.RLIMIT_CPU: (limits.cpu_seconds, limits.cpu_seconds + 1),  # the first says why
        resource.RLIMIT_FSIZE: (limits.file_bytes, limits.file_bytes),
        resource.RLIMIT_NOFILE: (limits.open_files, limits.open_files),
        resource.RLIMIT_NPROC: (0, 0),
        resource.RLIMIT_STACK: (_STACK_MB * _MB, _STACK_MB * _MB),
        resource.RLIMIT_CORE: (0, 0),
    }
    if limits.memory_mb is not None:
        limit_memory(limits.memory_mb * _MB)
    if limits.memory_mb is not None and addresses:
        max_addresses = addresses + (limits.memory_mb + _LIBRARIES_MB) * _MB
        maximum[resource.RLIMIT_AS] = (max_addresses, max_addresses)
    for kind, values in maximum.items():
        _, hard = resource.getrlimit(kind)
        soft, last = values if hard == resource.RLIM_INFINITY else (min(value, hard) for value in values)
        resource.setrlimit(kind, (soft, last))


def excess(pid: int, folder: Path, limits: Limits) -> str:
    """Return the text of the limits that a confined process exceeds by writing, "" if none; for its starter.

    Systems have no limit on all that a process writes, or on files in a folder: at a gigabyte a second it
    writes 50 MB more before it is seen. Files that it has removed count.
    """
    with suppress(OSError, ValueError):
        for line in Path(f"/proc/{pid}/io").read_text(encoding="ascii").splitlines():
            if line.startswith("wchar:") and int(line.split()[1]) > limits.written_bytes:
                return f"more than {limits.written_bytes / 1e6:g} MB written"
    with suppress(OSError):
        if len(list(islice(folder.rglob("*"), limits.files + 1))) > limits.files:
            return f"more than {limits.files} files written"
    return ""


@cache
def _readable() -> tuple[Path, ...]:
    """Return where Python and its modules are.

    Of a folder of modules outside Python's own, which may be anybody's, that is the packages and modules.
    """
    python_folders = [Path(folder).resolve() for folder in (sys.prefix, sys.base_prefix, *_SYSTEM)]
    places = list(python_folders)
    for entry in filter(None, (str(_ROOT), *sys.path)):
        folder = Path(entry).resolve()
        if folder.is_file() or any(folder.is_relative_to(part) for part in python_folders):
            places.append(folder)
        elif folder.is_dir():
            places += [path.parent for path in folder.glob("*/__init__.py")]
            places += folder.glob("*.py")
    return tuple(dict.fromkeys(places))
