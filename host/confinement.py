"""What a process that reads foreign bytes gives up before it reads them.

Whatever a file makes its reader do, a confined process opens no file but those of Python and of its own
folder, makes no connection, and ends at its limits of memory, CPU time and size of files. What the system
lacks is missing by name: `missing_protections`.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import stat
import struct
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

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
    """What a process that reads foreign bytes may take."""

    memory_mb: int | None = 512
    """Private memory that it may write, MB; None: as much as the process that started it."""
    cpu_seconds: int = 10
    """At their end the system kills it."""
    file_bytes: int = 256_000_000
    """Size of a file that it writes."""
    open_files: int = 64


READING = Limits()
"""The limits of every reader whose work is reading alone."""


def missing_protections() -> tuple[str, ...]:
    """Return the protections that this system lacks, by name."""
    present = {
        FILES: _landlock() > 0,
        NETWORK: _filters_calls(),
        LIMITS: sys.platform == "linux",
    }
    return tuple(name for name, has in present.items() if not has)


def confine(folder: Path, limits: Limits = READING) -> None:
    """Give up all that reading does not need; before other threads exist, and for good.

    `folder`: where the process reads its input and writes; everything beneath it is its own. Raises
    `OSError`: the system has a protection and refuses it.
    """
    missing = missing_protections()
    if LIMITS not in missing:
        _limit(limits)
    if FILES not in missing:
        _restrict(_readable(), folder)
    if NETWORK not in missing:
        _refuse_sockets()


def _limit(limits: Limits) -> None:
    if sys.platform == "win32":
        raise Unavailable("Limits of processes")
    import resource  # noqa: PLC0415 (POSIX alone)

    if limits.memory_mb is not None:
        limit_memory(limits.memory_mb * _MB)
    most = {
        resource.RLIMIT_CPU: (limits.cpu_seconds, limits.cpu_seconds + 1),  # the first says why
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


# Landlock, by which a process of Linux gives up files, connections and signals for good, as any user.


_CREATE, _ADD, _RESTRICT = 444, 445, 446
"""Numbers of the system calls, on every processor."""
_VERSION = 1
_PATH_BENEATH = 1
_NO_NEW_PRIVILEGES = 38
_READ_FILE, _READ_FOLDER = 1 << 2, 1 << 3
_OF_FILES = (1 << 1) | _READ_FILE | (1 << 14)  # write, read, truncate
_RIGHTS = {1: (1 << 13) - 1, 2: 1 << 13, 3: 1 << 14, 5: 1 << 15}
"""Rights to files by the version that brought them."""
_BIND_AND_CONNECT = 0b11
_NETWORK_SINCE, _SCOPES_SINCE = 4, 6
_ABSTRACT_SOCKETS_AND_SIGNALS = 0b11


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
        _allow(descriptor, folder, handled[0] & ~1)  # all but to execute
        _checked(ctypes.CDLL(None, use_errno=True).prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0))
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


# A filter of system calls (seccomp) by which a process of Linux gives up sockets for good.


_SET_SECCOMP, _FILTER = 22, 2
_ACTION_AVAILABLE = 2
_ALLOW, _REFUSE = 0x7FFF_0000, 0x0005_0000 | errno.EPERM
_LOAD, _IF_EQUAL, _IF_AT_LEAST, _RETURN = 0x20, 0x15, 0x35, 0x06
_NUMBER, _ARCHITECTURE = 0, 4
"""Offsets of the number of a call and of its architecture."""
_IO_URING_SETUP = 425
_OTHER_TABLE = 0x4000_0000
"""Numbers from here on name the same calls a second time (x32)."""
_PROCESSORS = {"x86_64": (0xC000_003E, 41, 317), "aarch64": (0xC000_00B7, 198, 277)}
"""Architecture, numbers of ``socket`` and ``seccomp``."""


class _Program(ctypes.Structure):
    """A filter: the number of its instructions, and where they are."""

    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.c_char_p))


def _filters_calls() -> bool:
    """Whether the system filters calls on this processor."""
    if sys.platform != "linux" or platform.machine() not in _PROCESSORS:
        return False
    action = ctypes.c_uint32(_REFUSE & 0xFFFF_0000)
    seccomp = _PROCESSORS[platform.machine()][2]
    return bool(ctypes.CDLL(None).syscall(seccomp, _ACTION_AVAILABLE, 0, ctypes.byref(action)) == 0)


def _refuse_sockets() -> None:
    """Let this thread, and what it starts, make no socket of any family.

    Raises `OSError`: the system refuses.
    """
    instructions = _instructions(*_PROCESSORS[platform.machine()][:2])
    program = _Program(len(instructions) // 8, instructions)
    library = ctypes.CDLL(None, use_errno=True)
    for arguments in ((_NO_NEW_PRIVILEGES, 1, 0, 0, 0), (_SET_SECCOMP, _FILTER, ctypes.byref(program), 0, 0)):
        _checked(library.prctl(*arguments))


def _instructions(architecture: int, socket: int) -> bytes:
    """Return the filter: calls of another architecture or table are refused like those for sockets.

    A jump counts the instructions that follow it; the last is the refusal.
    """
    steps = [
        (_LOAD, 0, 0, _ARCHITECTURE),
        (_IF_EQUAL, 0, 5, architecture),
        (_LOAD, 0, 0, _NUMBER),
        (_IF_AT_LEAST, 3, 0, _OTHER_TABLE),
        (_IF_EQUAL, 2, 0, socket),
        (_IF_EQUAL, 1, 0, _IO_URING_SETUP),
        (_RETURN, 0, 0, _ALLOW),
        (_RETURN, 0, 0, _REFUSE),
    ]
    return b"".join(struct.pack("HBBI", *step) for step in steps)
