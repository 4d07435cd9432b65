"""What a process that reads foreign bytes gives up before it reads them.

Whatever a file makes its reader do, a confined process opens no file but those of Python and of its own
folder, calls the system for what reading needs and nothing else (`host.system_calls`), and ends at its limits
of memory, CPU time and size of files. What the system lacks is missing by name: `missing_protections`.
"""

from __future__ import annotations

import ctypes
import errno
import os
import signal
import stat
import sys
from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from itertools import islice
from pathlib import Path

from host.extras import Unavailable
from host.reading_limits import READING, Limits
from host.system_calls import NO_NEW_PRIVILEGES, filters_calls, keep_to_reading

# Limits on what processes may take: POSIX systems alone have them, elsewhere each raises `Unavailable`.

FILES, CALLS, LIMITS = "files (Landlock)", "system calls (seccomp)", "memory and CPU time"
_ROOT = Path(__file__).resolve().parents[1]
_SYSTEM = ("/usr", "/lib", "/lib64", "/etc/ld.so.cache", "/etc/localtime", "/dev/null", "/dev/urandom")
_MB = 1 << 20
_SIGNAL_AT_END_OF_PARENT = 1
_LIBRARIES_MB = 1024
"""Addresses of libraries that are loaded later, beside memory: of scipy 130 MB, of gmsh 100 MB."""
_STACK_MB = 64
"""gmsh asks for a stack without limit, and does not get it."""
_CREATE, _ADD, _RESTRICT = 444, 445, 446
"""Numbers of the system calls, on every processor."""
_VERSION = 1
_PATH_BENEATH = 1
_WRITE_FILE, _READ_FILE, _READ_FOLDER, _REMOVE_FILE, _MAKE_FILE = (1 << bit for bit in (1, 2, 3, 5, 8))
_TRUNCATE = 1 << 14
_OF_FILES = _WRITE_FILE | _READ_FILE | _TRUNCATE
_OF_FOLDER = _OF_FILES | _READ_FOLDER | _REMOVE_FILE | _MAKE_FILE
_RIGHTS = {1: (1 << 13) - 1, 2: 1 << 13, 3: 1 << 14, 5: 1 << 15}
"""Rights to files by the version that brought them."""
_BIND_AND_CONNECT = 0b11
_NETWORK_SINCE, _SCOPES_SINCE = 4, 6
_ABSTRACT_SOCKETS_AND_SIGNALS = 0b11


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


def missing_protections() -> tuple[str, ...]:
    """Return the protections that this system lacks, by name."""
    present = {
        FILES: _landlock() > 0,
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
        _checked(ctypes.CDLL(None, use_errno=True).prctl(_SIGNAL_AT_END_OF_PARENT, signal.SIGKILL))
    if FILES not in missing:
        _restrict(_readable(), folder)
    if CALLS not in missing:
        keep_to_reading()


def prepare_confinement() -> None:
    """Find out once, in a process whose forks are confined, what is the same for all of them."""
    _readable()


def _threads_and_addresses() -> tuple[int, int]:
    """Return the number of threads of this process and the bytes of its addresses; 1 and 0 without /proc."""
    with suppress(OSError):
        fields = Path("/proc/self/stat").read_bytes().rpartition(b")")[2].split()
        return int(fields[17]), int(fields[20])
    return 1, 0


def _limit(limits: Limits, addresses: int) -> None:
    if sys.platform == "win32":
        raise Unavailable("Limits of processes")
    import resource  # noqa: PLC0415 (POSIX alone)

    most = {
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
        most_addresses = addresses + (limits.memory_mb + _LIBRARIES_MB) * _MB
        most[resource.RLIMIT_AS] = (most_addresses, most_addresses)
    for kind, values in most.items():
        _, hard = resource.getrlimit(kind)
        soft, last = values if hard == resource.RLIM_INFINITY else (min(value, hard) for value in values)
        resource.setrlimit(kind, (soft, last))


def excess(pid: int, folder: Path, limits: Limits) -> str:
    """Return what a confined process writes beyond its limits, "" if nothing; for whoever started it.

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
    own = [Path(folder).resolve() for folder in (sys.prefix, sys.base_prefix, *_SYSTEM)]
    places = list(own)
    for entry in filter(None, (str(_ROOT), *sys.path)):
        folder = Path(entry).resolve()
        if folder.is_file() or any(folder.is_relative_to(part) for part in own):
            places.append(folder)
        elif folder.is_dir():
            places += [path.parent for path in folder.glob("*/__init__.py")]
            places += folder.glob("*.py")
    return tuple(dict.fromkeys(places))


# Landlock, by which a process of Linux gives up files, connections and signals for good, as any user.


class _Beneath(ctypes.Structure):
    """What is allowed beneath an open file or folder."""

    _pack_ = 1
    _fields_ = (("rights", ctypes.c_uint64), ("descriptor", ctypes.c_int32))


def _landlock() -> int:
    """Return the version of Landlock that the system has, 0 if it has none."""
    return 0 if sys.platform != "linux" else max(_call(_CREATE, None, 0, _VERSION), 0)


def _restrict(readable: Iterable[Path], folder: Path) -> None:
    """Leave this thread, and what it starts, some files to read and one folder to write in.

    Connections by TCP, signals to other processes and sockets by name go with the files, where the system's
    version has that. `readable`: files and folders with all beneath them; those that do not exist are passed
    over. Raises `OSError`: the system refuses, or has no Landlock.
    """
    handled = _handled(_landlock())
    rules = (ctypes.c_uint64 * len(handled))(*handled)
    descriptor = _checked(_call(_CREATE, ctypes.byref(rules), ctypes.sizeof(rules), 0))
    try:
        for path in readable:
            _allow(descriptor, path, handled[0] & (_READ_FILE | _READ_FOLDER))
        _allow(descriptor, folder, handled[0] & _OF_FOLDER)
        _checked(ctypes.CDLL(None, use_errno=True).prctl(NO_NEW_PRIVILEGES, 1, 0, 0, 0))
        _checked(_call(_RESTRICT, descriptor, 0))
    finally:
        os.close(descriptor)


def _handled(present: int) -> list[int]:
    """Return the rights that a version takes: to files, to the network, to other processes."""
    handled = [sum(right for since, right in _RIGHTS.items() if since <= present)]
    if present >= _NETWORK_SINCE:
        handled.append(_BIND_AND_CONNECT)
    if present >= _SCOPES_SINCE:
        handled.append(_ABSTRACT_SOCKETS_AND_SIGNALS)
    return handled


def _allow(ruleset: int, path: Path, rights: int) -> None:
    try:
        descriptor = os.open(path, os.O_PATH | os.O_CLOEXEC)  # type: ignore[attr-defined, unused-ignore]
    except OSError:
        return
    try:
        of_kind = rights if stat.S_ISDIR(os.fstat(descriptor).st_mode) else rights & _OF_FILES
        beneath = _Beneath(of_kind, descriptor)
        _checked(_call(_ADD, ruleset, _PATH_BENEATH, ctypes.byref(beneath), 0))
    finally:
        os.close(descriptor)


def _call(number: int, *arguments: object) -> int:
    return int(ctypes.CDLL(None, use_errno=True).syscall(number, *arguments))


def _checked(outcome: int) -> int:
    """Return the outcome of a call; raise OSError if it failed."""
    if outcome < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return outcome
