"""Other processes as Linux shows them under /proc."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from host.extras import Unavailable

_PROC = Path("/proc")


def processes_in(directory: Path, command: str = "", proc: Path = _PROC) -> list[int]:
    """Return the other processes that work in or below a directory and whose command holds `command`.

    Raises
    ------
    Unavailable
        The system has no /proc.
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
    """Whether a process works there by such a command; not if it has ended or is another user's."""
    with suppress(OSError):
        place = (process / "cwd").readlink()
        return place.is_relative_to(directory) and command in (process / "cmdline").read_bytes()
    return False


def family_cpu_seconds(pid: int, proc: Path = _PROC) -> float | None:
    """Return the CPU seconds of a process and its descendants, those it has waited for and living ones.

    None where the system does not tell it, and once the process has ended.
    """
    with suppress(OSError, ValueError, IndexError):
        stat = (proc / str(pid) / "stat").read_text(encoding="ascii", errors="replace")
        ticks = sum(int(figure) for figure in stat.rpartition(")")[2].split()[11:15])  # own and of the dead
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
