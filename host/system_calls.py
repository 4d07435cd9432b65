"""A filter of system calls (seccomp): a process of Linux makes the calls of a reader and no others.

The list was recorded: all calls after `confine` of the readers of STEP, meshes, REXS, TOML, CSV, MDF4, UFF,
WAV, MAT and HDF5, of the tests' files and of files of 20 to 70 MB. Each stands with the names that other
versions of the C library have for it. No process or thread begins, none but the process itself gets a
signal, no limit, right or priority changes, and memory is private.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import struct
import sys
from dataclasses import dataclass

_ALLOWED: dict[str, tuple[int | None, int | None]] = {
    # files: Landlock says which
    "open": (2, None),
    "openat": (257, 56),
    "close": (3, 57),
    "read": (0, 63),
    "readv": (19, 65),
    "pread64": (17, 67),
    "write": (1, 64),
    "writev": (20, 66),
    "pwrite64": (18, 68),
    "lseek": (8, 62),
    "stat": (4, None),
    "lstat": (6, None),
    "fstat": (5, 80),
    "newfstatat": (262, 79),
    "statx": (332, 291),
    "access": (21, None),
    "faccessat": (269, 48),
    "faccessat2": (439, 439),
    "readlink": (89, None),
    "readlinkat": (267, 78),
    "getdents64": (217, 61),
    "getcwd": (79, 17),
    "flock": (73, 32),
    "unlink": (87, None),
    "unlinkat": (263, 35),
    # memory
    "munmap": (11, 215),
    "mprotect": (10, 226),
    "mremap": (25, 216),
    "madvise": (28, 233),
    "brk": (12, 214),
    # the process itself, time, chance
    "futex": (202, 98),
    "sched_yield": (24, 124),
    "getpid": (39, 172),
    "gettid": (186, 178),
    "uname": (63, 160),
    "getrusage": (98, 165),
    "times": (100, 153),
    "clock_gettime": (228, 113),
    "clock_nanosleep": (230, 115),
    "getrandom": (318, 278),
    "rt_sigaction": (13, 134),
    "rt_sigreturn": (15, 139),
    "restart_syscall": (219, 128),
    "exit": (60, 93),
    "exit_group": (231, 94),
}
"""Calls with any arguments: their numbers on x86-64 and on ARM64, None where a processor has no such call."""

# constants of the kernel's interface, in include/uapi of its sources
_MAP_KIND, _MAP_PRIVATE, _MAP_GROWS, _MAP_HUGE = 0x0F, 0x02, 0x100, 0x4_0000  # of mmap
_IS_TERMINAL, _CLOSE_ON_EXEC = 0x5401, 0x5451  # of ioctl
_GET_FLAGS, _SET_FLAGS, _GET_STATUS, _DUPLICATE = 1, 2, 3, 1030  # of fcntl
NO_NEW_PRIVILEGES, _SET_SECCOMP = 38, 22  # of prctl
_FILTER, _ACTION_AVAILABLE = 2, 2  # mode of prctl, operation of seccomp
_ALLOW, _REFUSE = 0x7FFF_0000, 0x0005_0000 | errno.EPERM  # results of a filter
_LOAD, _AND, _IF_EQUAL, _RETURN = 0x20, 0x54, 0x15, 0x06  # operations of a filter (BPF)
_NUMBER, _ARCHITECTURE, _ARGUMENTS = 0, 4, 16
"""Offsets of the number of a call, of its architecture and of its arguments in what a filter loads from."""
_PROCESSORS = {"x86_64": (0, 0xC000_003E, 317), "aarch64": (1, 0xC000_00B7, 277)}
"""Column of the numbers of calls, architecture, number of ``seccomp``."""
_Step = tuple[int, int, int, int]
"""An instruction: operation, instructions to skip if its condition holds and if not, operand."""


@dataclass(frozen=True)
class _Check:
    """A condition on an argument: its lower 32 bits, of which `mask` counts, are one of `values`."""

    word: int
    """Index of the 32 bits among all arguments, of 64 bits each: 2 n is the lower half of argument n."""
    values: tuple[int, ...]
    mask: int = 0xFFFF_FFFF


_Checked = tuple[tuple[int, int], tuple[_Check, ...]]
"""A call by its numbers on x86-64 and ARM64, and the conditions on its arguments."""


def _checked_calls(pid: int) -> tuple[_Checked, ...]:
    """Return the calls that are allowed with some arguments, and the conditions, in process `pid`."""
    itself, calling = (_Check(0, (pid,)),), _Check(0, (0,))
    private = _Check(6, (_MAP_PRIVATE,), _MAP_KIND | _MAP_GROWS | _MAP_HUGE)
    return (
        ((9, 222), (private,)),  # mmap: what is shared or grows by itself is in no limit on data
        ((16, 29), (_Check(2, (_IS_TERMINAL, _CLOSE_ON_EXEC)),)),  # ioctl
        ((72, 25), (_Check(2, (_GET_FLAGS, _SET_FLAGS, _GET_STATUS, _DUPLICATE)),)),  # fcntl: no F_SETOWN
        ((204, 123), (calling,)),  # sched_getaffinity
        ((234, 131), itself),  # tgkill: abort
        ((302, 261), (calling, _Check(4, (0,)), _Check(5, (0,)))),  # prlimit64: new limits are a null pointer
    )


class _Program(ctypes.Structure):
    """A filter: the number of its instructions, and where they are."""

    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.c_char_p))


def filters_calls() -> bool:
    """Whether the system filters calls on this processor."""
    if sys.platform != "linux" or platform.machine() not in _PROCESSORS:
        return False
    action = ctypes.c_uint32(_REFUSE & 0xFFFF_0000)  # without the number of the error
    _, _, seccomp = _PROCESSORS[platform.machine()]
    return bool(ctypes.CDLL(None).syscall(seccomp, _ACTION_AVAILABLE, 0, ctypes.byref(action)) == 0)


def keep_to_reading() -> None:
    """Refuse this thread, for good, every call that reading does not need; it fails as not permitted.

    Raises `OSError`: the system refuses.
    """
    column, architecture, _ = _PROCESSORS[platform.machine()]
    instructions = filter_program(column, architecture, os.getpid())
    program = _Program(len(instructions) // 8, instructions)
    library = ctypes.CDLL(None, use_errno=True)
    for arguments in ((NO_NEW_PRIVILEGES, 1, 0, 0, 0), (_SET_SECCOMP, _FILTER, ctypes.byref(program), 0, 0)):
        if library.prctl(*arguments) < 0:
            raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def filter_program(column: int, architecture: int, pid: int) -> bytes:
    """Return the instructions of the filter, 8 bytes each.

    Calls of another architecture are refused, and so are those by the second table of x86-64 (x32), whose
    numbers are larger than any of the list.

    Parameters
    ----------
    column : int
        Column of this processor's numbers of calls.
    architecture : int
        Identifier of the processor in the kernel (``AUDIT_ARCH``).
    pid : int
        Number of the process, which may signal itself.
    """
    steps: list[_Step] = [
        (_LOAD, 0, 0, _ARCHITECTURE),
        (_IF_EQUAL, 1, 0, architecture),
        (_RETURN, 0, 0, _REFUSE),
        (_LOAD, 0, 0, _NUMBER),
    ]
    for numbers in _ALLOWED.values():
        if (number := numbers[column]) is not None:
            steps += [(_IF_EQUAL, 0, 1, number), (_RETURN, 0, 0, _ALLOW)]
    for checked, checks in _checked_calls(pid):
        body = [step for check in checks for step in _steps_of(check)]
        body.append((_RETURN, 0, 0, _ALLOW))
        steps += [(_IF_EQUAL, 0, len(body), checked[column]), *body]
    steps.append((_RETURN, 0, 0, _REFUSE))
    return b"".join(struct.pack("HBBI", *step) for step in steps)


def _steps_of(check: _Check) -> list[_Step]:
    """Return the instructions that refuse a call unless a condition holds, and else go on behind them."""
    steps: list[_Step] = [(_LOAD, 0, 0, _ARGUMENTS + 4 * check.word), (_AND, 0, 0, check.mask)]
    count = len(check.values)
    steps += [(_IF_EQUAL, count - index, 0, value) for index, value in enumerate(check.values)]
    return [*steps, (_RETURN, 0, 0, _REFUSE)]
