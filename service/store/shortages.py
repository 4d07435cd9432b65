"""Space on the disks that are written to, and files that this process may still open."""

from __future__ import annotations

import errno
import os
import shutil
from contextlib import suppress
from pathlib import Path

MIN_FREE = 16_000_000
"""Bytes below which a folder counts as full: four times the longest body of a submission, which the database
writes more than once."""


def shortage(folder: Path | None) -> str:
    """Return a sentence on the lack of space in a folder, without its name; empty: it has space."""
    with suppress(OSError):  # what cannot be looked at is told by who writes there
        free = MIN_FREE if folder is None else shutil.disk_usage(folder).free
        if free < MIN_FREE:
            state = (
                f"{free / 1e6:.3g} MB are free where the service writes, and it needs {MIN_FREE / 1e6:g} MB"
            )
            return f"There is no space left: {state}. Make room on its disk."
    return ""


def out_of_files() -> bool:
    """Whether neither this process nor the system opens one more file."""
    try:
        os.close(os.open(os.devnull, os.O_RDONLY))
    except OSError as error:
        return error.errno in (errno.EMFILE, errno.ENFILE)
    return False
