"""Landlock, by which a process of Linux gives up files, connections and signals for good, as any user."""

from __future__ import annotations

import ctypes
import os
import stat
import struct
import sys
from collections.abc import Iterable
from pathlib import Path

from host.system_calls import NO_NEW_PRIVILEGES

_CREATE, _ADD, _RESTRICT = 444, 445, 446
"""Numbers of the system calls, on every processor."""
_VERSION = 1  # a flag: return the version, make nothing
_PATH_BENEATH = 1  # kind of a rule: rights beneath a path
_WRITE_FILE, _READ_FILE, _READ_FOLDER, _REMOVE_FILE, _MAKE_FILE = (1 << bit for bit in (1, 2, 3, 5, 8))
_TRUNCATE = 1 << 14
_OF_FILES = _WRITE_FILE | _READ_FILE | _TRUNCATE
_OF_FOLDER = _OF_FILES | _READ_FOLDER | _REMOVE_FILE | _MAKE_FILE
_RIGHTS = {1: (1 << 13) - 1, 2: 1 << 13, 3: 1 << 14, 5: 1 << 15}
"""Bits of the rights to files that each version of Landlock introduced."""
_BIND_AND_CONNECT = 0b11
_NETWORK_SINCE, _SCOPES_SINCE = 4, 6  # versions
_ABSTRACT_SOCKETS_AND_SIGNALS = 0b11
_BENEATH = "=Qi"
"""Rule of rights beneath an open file or folder, packed: the rights, the descriptor."""


def landlock_version() -> int:
    """Return the version of Landlock that the system has, 0 if it has none."""
    return 0 if sys.platform != "linux" else max(_call(_CREATE, None, 0, _VERSION), 0)


def restrict(readable: Iterable[Path], folder: Path) -> None:
    """Leave this thread, and what it starts, some files to read and one folder to write in.

    Connections by TCP, signals to other processes and sockets by name go with the files, where the system's
    version has that. `readable`: files and folders with all beneath them; those that do not exist are passed
    over. Raises `OSError`: the system refuses, or has no Landlock.
    """
    handled = _handled(landlock_version())
    rules = (ctypes.c_uint64 * len(handled))(*handled)
    descriptor = checked(_call(_CREATE, ctypes.byref(rules), ctypes.sizeof(rules), 0))
    try:
        for path in readable:
            _allow(descriptor, path, handled[0] & (_READ_FILE | _READ_FOLDER))
        _allow(descriptor, folder, handled[0] & _OF_FOLDER)
        checked(ctypes.CDLL(None, use_errno=True).prctl(NO_NEW_PRIVILEGES, 1, 0, 0, 0))
        checked(_call(_RESTRICT, descriptor, 0))
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
        checked(_call(_ADD, ruleset, _PATH_BENEATH, struct.pack(_BENEATH, of_kind, descriptor), 0))
    finally:
        os.close(descriptor)


def _call(number: int, *arguments: object) -> int:
    return int(ctypes.CDLL(None, use_errno=True).syscall(number, *arguments))


def checked(outcome: int) -> int:
    """Return the outcome of a call; raise OSError if it failed."""
    if outcome < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return outcome
