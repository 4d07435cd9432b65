"""Processes of this machine: sessions, signals, ends and priorities on POSIX, other processes by /proc.

A function that the system cannot serve raises `Unavailable`.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from host.extras import Unavailable

RESIDENT_UNIT = 1 if sys.platform == "darwin" else 1024
"""Bytes in which POSIX systems report resident memory: macOS in 1, Linux in 1024."""

_PROC = Path("/proc")


class Ended(NamedTuple):
    """An ended child."""

    code: int
    """Exit code, or the negative number of the signal that ended it."""
    cpu_seconds: float
    """CPU seconds of the child and of its children that it has waited for."""
    peak_memory: int
    """Peak resident memory, bytes."""


def ending_signal(code: int) -> str:
    """Return the name of the signal that ended a process with this code, "" if none did."""
    return signal.Signals(-code).name if code < 0 else ""


def require_sessions() -> None:
    """Raise `Unavailable` where processes have no sessions of their own."""
    if sys.platform == "win32":
        raise Unavailable("Sessions of processes, in which the service's workers run,")


def lead_session() -> None:
    """Make this process the leader of a new session and group."""
    if sys.platform == "win32":
        raise Unavailable("Sessions of processes")
    os.setsid()


def kill_group(leader: int) -> None:
    """End a group of processes at once. ProcessLookupError: there is none."""
    if sys.platform == "win32":
        raise Unavailable("Groups of processes")
    os.killpg(leader, signal.SIGKILL)


def kill_process_group() -> None:
    """End this process and its group at once."""
    if sys.platform == "win32":
        raise Unavailable("Groups of processes")
    os.killpg(os.getpgrp(), signal.SIGKILL)


def kill(pid: int, *, as_crash: bool = False) -> None:
    """End a process at once, `as_crash` as native code would. ProcessLookupError: there is none."""
    if sys.platform == "win32":
        raise Unavailable("Signals to processes")
    os.kill(pid, signal.SIGSEGV if as_crash else signal.SIGKILL)


def lower_priority(niceness: int) -> None:
    """Let other processes go before this one."""
    if sys.platform == "win32":
        raise Unavailable("Niceness values")
    os.nice(niceness)


def never_wait_at(pipe: int) -> None:
    """Let reads and writes at the end of a pipe raise BlockingIOError in place of waiting."""
    if sys.platform == "win32":
        raise Unavailable("Pipes that do not wait")
    os.set_blocking(pipe, False)


def has_exited(child: int) -> bool:
    """Whether a child has ended. It is not reaped, so that no other process gets its id."""
    if sys.platform == "win32":
        raise Unavailable("Children that wait to be reaped")
    if hasattr(os, "waitid"):
        return os.waitid(os.P_PID, child, os.WEXITED | os.WNOWAIT | os.WNOHANG) is not None
    status = subprocess.run(  # macOS before Python 3.13
        ["ps", "-o", "stat=", "-p", str(child)], capture_output=True, text=True, check=False
    )
    return status.stdout.strip()[:1] in {"Z", ""}


def reap(child: int) -> Ended:
    """Wait for the end of a child."""
    if sys.platform == "win32":
        raise Unavailable("Children that wait to be reaped")
    _, status, usage = os.wait4(child, 0)
    cpu_seconds, code = usage.ru_utime + usage.ru_stime, os.waitstatus_to_exitcode(status)
    return Ended(code, cpu_seconds, RESIDENT_UNIT * usage.ru_maxrss)


def processes_in(directory: Path, command: str = "", proc: Path = _PROC) -> list[int]:
    """Return the other processes that work in or below a directory and whose command holds `command`.

    Raises `Unavailable`: the system has no /proc.
    """
    return [pid for pid in _numbered(proc) if _works_in(proc / str(pid), directory, command.encode())]


def _numbered(proc: Path) -> Iterator[int]:
    """Yield the ids of all processes but this one."""
    if not (proc / "self" / "status").is_file():
        raise Unavailable("Lists of processes (/proc)", "Use Linux.")
    for entry in proc.iterdir():
        if entry.name.isdigit() and int(entry.name) != os.getpid():
            yield int(entry.name)


def _works_in(process: Path, directory: Path, command: bytes) -> bool:
    """Whether a process works in a directory and its command line holds `command`.

    It is False for a process that has ended, and for one of another user.
    """
    with suppress(OSError):
        folder = (process / "cwd").readlink()
        return folder.is_relative_to(directory) and command in (process / "cmdline").read_bytes()
    return False


def family_cpu_seconds(pid: int, proc: Path = _PROC) -> float | None:
    """Return the CPU seconds of a process and its descendants, those it has waited for and living ones.

    None where the system does not tell it, and once the process has ended.
    """
    with suppress(OSError, ValueError, IndexError):
        stat = (proc / str(pid) / "stat").read_text(encoding="ascii", errors="replace")
        # after the name in brackets: user and system time of the process and of the children it has waited
        # for
        ticks = sum(int(figure) for figure in stat.rpartition(")")[2].split()[11:15])
        children = [int(c) for t in (proc / str(pid) / "task").iterdir() for c in _children(t)]
        return ticks / os.sysconf("SC_CLK_TCK") + sum(family_cpu_seconds(c, proc) or 0.0 for c in children)
    return None


def _children(task: Path) -> list[str]:
    """Return the ids of the children of a task; none where the system does not list them."""
    with suppress(OSError):
        return (task / "children").read_text(encoding="ascii").split()
    return []


def memory_figure(name: str, pid: int | str = "self", proc: Path = _PROC) -> int | None:
    """Return a figure of a process's memory in bytes, such as VmHWM or VmData.

    None where the system does not tell it, and once the process has ended.
    """
    with suppress(OSError, ValueError):
        for line in (proc / str(pid) / "status").read_text(encoding="ascii", errors="replace").splitlines():
            if line.startswith(f"{name}:"):
                return 1024 * int(line.split()[1])
    return None
