"""Questions about files of callers: each is answered by a confined child in a folder of its own.

A few are read at the same time, one of each caller; another of the same caller waits, a third is refused. So
whoever sends files that take all they may holds up nobody else.
"""

from __future__ import annotations

import threading
import uuid
from collections import OrderedDict
from concurrent.futures import Future
from dataclasses import dataclass, field
from pathlib import Path

import structlog

from host import missing_protections
from lineofaction.gearbox.problems import LiveUnavailable, QueueFull, TooManyHeld
from service.live.order import LiveOrder
from service.own_folder import remove_left
from service.reading.reader import Reader

AT_ONCE = 4
MOST_WAITING = 16
_AGAIN_S = 1

logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class _Question:
    """What one caller waits for."""

    order: LiveOrder
    answer: Future[bytes] = field(default_factory=Future)


class ReadingPool:
    """Has files read, each by a process of its own.

    Parameters
    ----------
    data_directory : Path
        Where folders of readers and their logs are; folders that were left there are removed.
    """

    def __init__(self, data_directory: Path) -> None:
        self._home = data_directory / "reading"
        self._reader = Reader(self._home, data_directory / "log")
        self._waiting: OrderedDict[str, _Question] = OrderedDict()
        self._running: dict[str, threading.Thread] = {}
        self._changed = threading.Lock()
        self._stopping = False
        remove_left(self._home)
        if missing := missing_protections():
            logger.warning("this system does not confine the readers of files", missing=missing)

    def ask(self, order: LiveOrder, caller: str | None = None) -> Future[bytes]:
        """Enter a question; the future holds the bytes of its JSON answer, or the error.

        Parameters
        ----------
        order : LiveOrder
            Its work is called as ``function(inputs, folder)``.
        caller : str, optional
            Whose other questions come one after the other; default: nobody else's.

        Raises
        ------
        TooManyHeld
            A question of the caller waits already.
        QueueFull
            Too many wait.
        LiveUnavailable
            The service stops.
        """
        name, question = caller or uuid.uuid4().hex, _Question(order)
        with self._changed:
            if self._stopping:
                raise LiveUnavailable("The service stops.")
            if name in self._waiting:
                text = f"A file of key {name!r} is being read, and another waits. Try again soon."
                raise TooManyHeld.after(_AGAIN_S, text)
            if len(self._waiting) >= MOST_WAITING:
                raise QueueFull.after(_AGAIN_S, f"{MOST_WAITING} files wait to be read. Try again soon.")
            self._waiting[name] = question
            self._begin()
        return question.answer

    def stop(self) -> None:
        """Refuse what waits, end the readers; a question that comes later begins anew."""
        with self._changed:
            self._stopping = True
            for question in self._waiting.values():
                question.answer.set_exception(LiveUnavailable("The service stops."))
            self._waiting.clear()
            running = list(self._running.values())
        self._reader.stop()
        for thread in running:
            thread.join()
        self._reader.close()
        self._stopping = False

    def _begin(self) -> None:
        """Let those that have waited longest begin, one of each caller."""
        for name in list(self._waiting):
            if len(self._running) < AT_ONCE and name not in self._running:
                question = self._waiting.pop(name)
                self._running[name] = threading.Thread(
                    target=self._settle, args=(name, question), daemon=True
                )
                self._running[name].start()

    def _settle(self, name: str, question: _Question) -> None:
        """Give a question its answer or its error, and let the next begin."""
        try:
            if question.answer.set_running_or_notify_cancel():
                question.answer.set_result(self._reader.read(question.order))
        except Exception as error:  # noqa: BLE001 (whoever asked is told)
            question.answer.set_exception(error)
        finally:
            with self._changed:
                del self._running[name]
                self._begin()
