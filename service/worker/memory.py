"""Memory of a worker: how much it may have, and how it is held to it.

The limit is on the private memory that a process may write: it counts neither shared libraries nor
files, of which a worker maps as much as it has data, and the allocation beyond it fails where it is made, so
that the work ends as any other failure. A process that the work starts, such as the mesher, has its own
allowance of the same size. Linux heeds the limit; other systems may not.
"""

from __future__ import annotations

from pathlib import Path

from host import limit_memory, physical_memory

_MB = 1 << 20
_GROUP_LIMIT = Path("/sys/fs/cgroup/memory.max")


def machine_memory_mb(group_limit: Path = _GROUP_LIMIT) -> int:
    """Return the memory of the machine, MB, or what its control group (a container) leaves of it."""
    physical = physical_memory()
    try:
        allowed = int(group_limit.read_text())
    except (OSError, ValueError):  # no control groups, or "max"
        allowed = physical
    return min(physical, allowed) // _MB


def hold_to(limit_mb: int) -> None:
    """Let allocations of this process fail beyond so many MB; a stricter limit of the system stays."""
    limit_memory(limit_mb * _MB)


def out_of_memory(limit_mb: int) -> str:
    """Return the message of a job that needed more."""
    return (
        f"The computation ran out of memory: it may have {limit_mb} MB (LOA_MEMORY_LIMIT_MB). Select a "
        "coarser level or fewer positions, or start the service with a higher limit."
    )
