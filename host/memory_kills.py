"""Number of processes that the system has killed for lack of memory: it tells these from other SIGKILLs."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

_PROC, _GROUPS = Path("/proc"), Path("/sys/fs/cgroup")


def memory_kills(proc: Path = _PROC, groups: Path = _GROUPS) -> int | None:
    """Return the number of processes killed for lack of memory in the control group of this process.

    Where no control group counts them (version 1, or none), the number on the whole machine. None where the
    system counts neither. The system counts a kill before the process is dead.
    """
    for file in (_memory_events(proc, groups), groups / "memory.events", proc / "vmstat"):
        with suppress(OSError, ValueError):
            for line in file.read_text(encoding="ascii").splitlines():
                name, _, count = line.partition(" ")
                if name == "oom_kill":
                    return int(count)
    return None


def _memory_events(proc: Path, groups: Path) -> Path:
    """Return the file in which version 2 counts events of the memory of this process's group."""
    with suppress(OSError):
        for line in (proc / "self" / "cgroup").read_text(encoding="utf-8").splitlines():
            if line.startswith("0::"):
                return groups / line[len("0::") :].strip("/") / "memory.events"
    return groups / "memory.events"
