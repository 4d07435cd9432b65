"""Check whether a service can write, by a trial write in a separate thread."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures import TimeoutError as NotDone
from dataclasses import dataclass

import structlog

from lineofaction.gearbox.problems import BadInput, DatabaseUnavailable, ServiceError
from service.store.deployment import Deployment
from service.store.integrity import IntegrityCheck

logger = structlog.get_logger(__name__)
VALID_S = 1.0
"""Seconds for which an outcome is valid: the next check repeats it without a new write."""
PATIENCE_S = 0.8
"""Longest wait for the trial in s: supervisors ask for an answer within a second."""
LATE_S = 10.0
"""Seconds after a successful write in which a waiting write is no fault, since many may write at once. A
submission waits as long for its turn."""


@dataclass(frozen=True)
class _Writable:
    """Faults of writing by part, empty if there is none.

    `late`: the database did not answer in time, or others held it. That is no proof of a fault.
    """

    database: str = ""
    results: str = ""
    late: bool = False

    @property
    def fault(self) -> str:
        """The first fault, in a sentence."""
        return self.database or self.results


class WriteCheck:
    """Trial writes to the database and the place of results, at most once in `VALID_S`.

    A database that the integrity check finds damaged counts as not writable.
    """

    def __init__(self, deployment: Deployment, integrity: IntegrityCheck | None = None) -> None:
        self._deployment, self._integrity = deployment, integrity
        self._lock = threading.Lock()
        self._outcome: Future[_Writable] | None = None
        self._begun = 0.0
        self._succeeded = -math.inf

    def outcome(self) -> _Writable:
        """Return the faults of writing, within `PATIENCE_S`."""
        with self._lock:
            old = time.monotonic() - self._begun > VALID_S
            if self._outcome is None or (old and self._outcome.done()):
                self._begun, self._outcome = time.monotonic(), Future()
                threading.Thread(target=self._try, args=(self._outcome,), daemon=True).start()
            outcome = self._outcome
        try:
            written = outcome.result(timeout=PATIENCE_S)
        except NotDone:
            text = f"What is written to the database and the results is not there after {PATIENCE_S:g} s."
            written = _Writable(text, text, late=True)
        waits = written.late and time.monotonic() - self._succeeded < LATE_S
        return _Writable() if waits else written

    def _try(self, outcome: Future[_Writable]) -> None:
        started = time.monotonic()
        results, _ = self._fault("results", self._deployment.write_results)
        database, late = self._fault("database", self._write_database)
        written = _Writable(database, results, late=late and not results)
        if not written.fault:
            self._succeeded = started
        outcome.set_result(written)

    def _write_database(self) -> None:
        if self._integrity is not None:
            self._integrity.confirm()
        self._deployment.write_database()

    @staticmethod
    def _fault(part: str, step: Callable[[], None]) -> tuple[str, bool]:
        """Return the fault of a step, without names of files, and whether the step may only be late."""
        try:
            step()
        except BadInput as error:
            logger.warning("cannot be written", part=part, error=str(error))
            return (
                "The place of results belongs to another deployment or refuses writing. The log says more.",
                False,
            )
        except ServiceError as error:
            return str(error), type(error) is DatabaseUnavailable
        except OSError as error:
            return f"The place of results cannot be written: {error.strerror}.", False
        except Exception:
            logger.exception("write check failed", part=part)
            return f"An unexpected failure occurred while the {part} was written. The log says more.", False
        return "", False
