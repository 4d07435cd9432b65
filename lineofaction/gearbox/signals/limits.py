"""Limits of a process that reads a recording: recordings are larger than other files of foreign bytes."""

from host import Limits

READING = Limits(memory_mb=2048, cpu_seconds=60, file_bytes=700_000_000, written_bytes=800_000_000)
SECONDS = 90.0
LARGEST_FILE = 256_000_000
"""Largest size in bytes of a file that is read."""
