"""How a process ended."""

from __future__ import annotations

import signal
import sys
from typing import NamedTuple

RESIDENT_UNIT = 1 if sys.platform == "darwin" else 1024
"""Bytes in which POSIX systems report resident memory: macOS in 1, Linux in 1024."""


class Ended(NamedTuple):
    """An ended child.

    Attributes
    ----------
    code : int
        Exit code, or the negative number of the signal that ended it.
    cpu_seconds : float
        Of the child and of those it has waited for.
    peak_memory : int
        Most resident memory, bytes.
    """

    code: int
    cpu_seconds: float
    peak_memory: int


def ending_signal(code: int) -> str:
    """Return the name of the signal that ended a process with this code, "" if none did."""
    return signal.Signals(-code).name if code < 0 else ""
