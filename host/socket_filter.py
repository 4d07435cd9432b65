"""A filter of system calls (seccomp) by which a process of Linux gives up sockets for good."""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import struct
import sys

_SET_SECCOMP, _FILTER, _NO_NEW_PRIVILEGES = 22, 2, 38
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


def available() -> bool:
    """Whether the system filters calls on this processor."""
    if sys.platform != "linux" or platform.machine() not in _PROCESSORS:
        return False
    action = ctypes.c_uint32(_REFUSE & 0xFFFF_0000)
    seccomp = _PROCESSORS[platform.machine()][2]
    return bool(ctypes.CDLL(None).syscall(seccomp, _ACTION_AVAILABLE, 0, ctypes.byref(action)) == 0)


def refuse_sockets() -> None:
    """Let this thread, and what it starts, make no socket of any family.

    Raises
    ------
    OSError
        The system refuses.
    """
    instructions = _instructions(*_PROCESSORS[platform.machine()][:2])
    program = _Program(len(instructions) // 8, instructions)
    library = ctypes.CDLL(None, use_errno=True)
    for arguments in ((_NO_NEW_PRIVILEGES, 1, 0, 0, 0), (_SET_SECCOMP, _FILTER, ctypes.byref(program), 0, 0)):
        if library.prctl(*arguments) != 0:
            raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


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
