"""The start of work in a process, and its use of the machine: CPU time, memory, disk."""

from __future__ import annotations

import errno
import signal
import warnings
from dataclasses import dataclass
from pathlib import Path

from host import limit_memory, physical_memory

BYTES_PER_MB = float(1 << 20)
_MB = 1 << 20
_GROUP_LIMIT = Path("/sys/fs/cgroup/memory.max")
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""Errors of a full disk: no space, quota used up, or largest size of a file reached."""


def begin_work() -> None:
    """Ignore Ctrl-C, which the service takes, and warnings of implausible inputs, which the caller gets."""
    warnings.filterwarnings("ignore", message="implausible")
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@dataclass(frozen=True)
class Usage:
    """Resources of a worker: elapsed s, CPU s including ended children, largest resident memory in MB.

    The process reports its memory with its outcome. Without a report it is the system's figure, which is at
    least the memory of the parent: until the program is loaded, the system counts that.
    """

    seconds: float
    cpu_s: float
    peak_mb: float

    def as_json(self) -> dict[str, float]:
        """Return it rounded, for a line of the log."""
        return {
            "seconds": round(self.seconds, 3),
            "cpu_s": round(self.cpu_s, 3),
            "peak_mb": round(self.peak_mb, 1),
        }


def machine_memory_mb(group_limit: Path = _GROUP_LIMIT) -> int:
    """Return the memory of the machine or of its control group (a container), MB, the smaller one."""
    physical = physical_memory()
    try:
        allowed = int(group_limit.read_text())
    except (OSError, ValueError):  # no control groups, or "max"
        allowed = physical
    return min(physical, allowed) // _MB


def hold_to(limit_mb: int) -> None:
    """Limit the memory of this process: further allocations fail; a stricter limit of the system stays."""
    limit_memory(limit_mb * _MB)


def no_space(error: OSError, where: str = "the data directory of the service (LOA_DATA_DIRECTORY)") -> str:
    """Return the message of a job whose files found no space; empty for another error."""
    if error.errno not in _FULL:
        return ""
    return (
        f"The result could not be written: there is no space left in {where}. "
        "Make room there, or raise the quota, and submit again."
    )
