"""Signs of one process: whether it is alive, and whether it can work."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from dataclasses import dataclass

from service.queue.scheduler import Scheduler
from service.store.write_check import WriteCheck

TURN_WITHIN_S = 120.0
"""A scheduler whose turn takes longer is stuck: a turn may wait for locks of the database and for an object
store, each for some 10 s."""
_ANSWER_WITHIN_S = 0.8
"""Supervisors wait for a second."""


@dataclass
class EventLoop:
    """The loop that answers requests, seen from another thread; `loop` is None until the program serves."""

    loop: asyncio.AbstractEventLoop | None = None

    def fault(self) -> str:
        """Return the fault of the loop; empty where it turns, or has not begun."""
        turned = threading.Event()
        if self.loop is not None:
            self.loop.call_soon_threadsafe(turned.set)
            if not turned.wait(_ANSWER_WITHIN_S):
                return f"The loop of requests has not turned for {_ANSWER_WITHIN_S:g} s."
        return ""


@dataclass(frozen=True)
class Vitals:
    """The signs of life of one process. A fault is a sentence; empty: no fault.

    `serving` returns the fault of the loop that answers requests, in a process that has one.
    """

    scheduler: Scheduler | None
    writes: WriteCheck
    serving: Callable[[], str] = lambda: ""

    def fault_of_health(self) -> str:
        """Return the reason to start the process again; empty: none."""
        if self.scheduler is not None and not self.scheduler.alive:
            return "The scheduler does not run. Restart the service."
        if self.scheduler is not None and self.scheduler.turn_age_s > TURN_WITHIN_S:
            return f"The scheduler has not turned for {TURN_WITHIN_S:g} s. Restart the service."
        return self.serving()

    def fault_of_readiness(self) -> str:
        """Return the reason why the process cannot work now: a failed write, or its own health."""
        return self.writes.outcome().fault or self.fault_of_health()
