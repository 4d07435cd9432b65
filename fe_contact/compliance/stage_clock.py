"""CPU time of the stages of a computation."""

from __future__ import annotations

import os
import time


class StageClock:
    """CPU seconds of this process and its finished children, stage by stage."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = self._now()

    def finish(self, stage: str) -> None:
        """Book the time since the last stage."""
        now = self._now()
        self.seconds[stage], self._last = now - self._last, now

    @staticmethod
    def _now() -> float:
        times = os.times()
        return time.process_time() + times.children_user + times.children_system
