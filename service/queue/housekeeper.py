"""The thread that removes, once an hour, what retention does not ask to keep."""

from __future__ import annotations

import threading

import structlog

from lineofaction.gearbox.problems import ServiceError
from service.queue.retention import Retention

FIRST_S, EVERY_S = 60.0, 3600.0
logger = structlog.get_logger(__name__)


class Housekeeper:
    """Collects beside the scheduler; several on one database do each other no harm.

    Parameters
    ----------
    retention : Retention
    days : float
        How long results and ended jobs are kept that nobody asks for.
    """

    def __init__(self, retention: Retention, days: float) -> None:
        self._retention, self._days = retention, days
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Begin."""
        self._stopping.clear()
        self._thread = threading.Thread(target=self._loop, name="housekeeper", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End, after what is being removed just now."""
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()

    def _loop(self) -> None:
        """Until stopped: collect, and wait."""
        pause = FIRST_S
        while not self._stopping.wait(pause):
            pause = EVERY_S
            try:
                removed = 0
                for _ in self._retention.expire(self._days):
                    removed += 1
                    if self._stopping.is_set():
                        break
                logger.info("collected", removed=removed)
            except ServiceError as error:
                logger.warning("nothing collected", error=str(error))
            except Exception:
                logger.exception("collection failed")
