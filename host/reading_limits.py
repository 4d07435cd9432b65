"""Limits of memory, time and files for a process that reads foreign bytes."""

from __future__ import annotations

from dataclasses import dataclass

LOOK_S = 0.05
"""Interval at which the starter of a confined process checks what it has written, s."""


@dataclass(frozen=True)
class Limits:
    """Limits of memory, time and files for a process that reads foreign bytes."""

    memory_mb: int | None = 512
    """Private memory that the process may write, MB; None: as much as its starter."""
    cpu_seconds: int = 10
    """CPU time after which the system kills the process, s."""
    file_bytes: int = 256_000_000
    """Largest size of a written file, bytes."""
    written_bytes: int = 400_000_000
    files: int = 100
    """`written_bytes`, `files`: Largest number of written bytes, the answer among them, and of files in the
    folder of the process. The starter checks both (`excess`).
    """
    open_files: int = 64


READING = Limits()
"""Limits of every reader that does nothing but read."""
