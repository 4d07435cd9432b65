"""What a process that reads foreign bytes may take of memory, time and files."""

from __future__ import annotations

from dataclasses import dataclass

LOOK_S = 0.05
"""How often whoever started a confined process looks at what it has written."""


@dataclass(frozen=True)
class Limits:
    """What a process that reads foreign bytes may take."""

    memory_mb: int | None = 512
    """Private memory that it may write, MB; None: as much as the process that started it."""
    cpu_seconds: int = 10
    """At their end the system kills it."""
    file_bytes: int = 256_000_000
    """Size of a file that it writes."""
    written_bytes: int = 400_000_000
    files: int = 100
    """`written_bytes`, `files`: All bytes that it writes, its answer among them, and files in its folder:
    whoever started it looks (`excess`).
    """
    open_files: int = 64


READING = Limits()
"""The limits of every reader whose work is reading alone."""
