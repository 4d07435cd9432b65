"""Limits that a system does not enforce: the starter of a child checks them."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from host.confinement import excess
from host.reading_limits import LOOK_S, Limits


@dataclass(frozen=True)
class Watch:
    """Time limit of a child, and limits of what it writes into its folder."""

    seconds: float
    """Time limit, s, from the start of the watch."""
    end: float
    """Instant of `time.monotonic` at which the time is over."""
    folder: Path | None = None
    """Folder that the child writes into, if it confines itself to one."""
    limits: Limits | None = None

    @classmethod
    def begun(cls, seconds: float, folder: Path | None = None, limits: Limits | None = None) -> Watch:
        """Return a watch that begins now."""
        return cls(seconds, time.monotonic() + seconds, folder, limits)

    @property
    def late(self) -> bool:
        """Whether the time is over."""
        return time.monotonic() >= self.end

    def excess(self, child: int) -> str:
        """Return the text of the limits that a child's writing exceeds, "" if none."""
        if self.folder is None or self.limits is None:
            return ""
        return excess(child, self.folder, self.limits)

    @property
    def pause(self) -> float:
        """Time until the next look, s."""
        left = max(self.end - time.monotonic(), 0.0)
        return left if self.limits is None else min(left, LOOK_S)
