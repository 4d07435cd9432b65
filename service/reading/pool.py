"""Questions about files of callers: each is answered by a confined child in a folder of its own.

A few are read at the same time, one of each caller; another of the same caller waits, a third is refused. So
whoever sends files that take all they may holds up nobody else.
"""

from __future__ import annotations

import os
import select
import threading
import time
import uuid
from collections import OrderedDict
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import structlog

from host import READING, Ended, ending_signal, kill_group, missing_protections
from lineofaction.gearbox.problems import (
    LiveUnavailable,
    QueueFull,
    ServiceError,
    TooLarge,
    TooManyHeld,
    Unexpected,
)
from service.folders import own_folder, remove_left
from service.live.order import AnswerHead, LiveOrder, propagated
from service.reading.child import LONGEST_S, MOST_ANSWER_BYTES
from service.worker.forks import ChildProcess, Ends, Forks

# The reader seen from the service: start, ask, end, and leave nothing behind.


WORK = "service.reading.child"
MODULES = (
    "lineofaction.gearbox.convert.errors",
    "lineofaction.gearbox.from_rexs.opened",
    "service.reading.texts",
    "scipy.optimize",
)
_WARM_WITHIN_S = 30.0
_PATIENCE_S = 2.0
"""The child ends itself first, and so says why."""
_LONGEST_HEAD = 1_000
_PIECE = 1 << 16
_MORE = "Split the files, or leave out what they do not need."

logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class _Pipes:
    """Our ends of the pipes to a child: the order goes one way, the answer comes the other."""

    orders: int
    answers: int


class _Reader:
    """Starts a child for each question, forked from a warm process where the system forks. For any thread.

    Each child has a folder of its own below `home`.
    """

    def __init__(self, home: Path, logs: Path) -> None:
        self._home, self._log = home, logs / "reading.log"
        self._forks = Forks(MODULES, logs / "reading_warm.log", WORK)
        self._launching = threading.Lock()
        self._children: set[int] = set()
        self._stopping = False

    def read(self, order: LiveOrder) -> bytes:
        """Return the JSON answer of a child that reads what the order holds.

        Raises `ServiceError` as the child found it; `TooLarge`: reading takes more than a reader may;
        `LiveUnavailable`.
        """
        with own_folder(self._home) as folder:
            child, pipes = self._started(folder)
            try:
                # a child that died before it has read the order shows by its answer
                with suppress(BrokenPipeError), os.fdopen(pipes.orders, "wb") as stream:
                    stream.write(order.line())
                answer = _heard(pipes.answers, time.monotonic() + LONGEST_S + _PATIENCE_S)
            finally:
                os.close(pipes.answers)
                ended = self._end(child)
        if answer is None:
            raise self._cause(ended)
        return self._unpacked(answer, order)

    def stop(self) -> None:
        """End all children, whose callers are told so."""
        self._stopping = True
        for pid in tuple(self._children):
            with suppress(ProcessLookupError):
                kill_group(pid)

    def close(self) -> None:
        """End the warm process, once no child is left; later children start another."""
        self._forks.close()
        self._stopping = False

    def _started(self, folder: Path) -> tuple[ChildProcess, _Pipes]:
        theirs, orders = os.pipe()
        answers, channel = os.pipe()
        self._log.parent.mkdir(parents=True, exist_ok=True)
        try:
            with self._log.open("ab") as log, self._launching:
                child = self._forks.launch(Ends(theirs, channel, log.fileno(), folder), _WARM_WITHIN_S)
                self._children.add(child.pid)
        except OSError:
            os.close(orders)
            os.close(answers)
            raise LiveUnavailable("The system starts no reader now. Try again soon.") from None
        finally:
            os.close(theirs)
            os.close(channel)
        return child, _Pipes(orders, answers)

    def _end(self, child: ChildProcess) -> Ended:
        """Kill a child and what it started; return how it ended: one that has ended is not killed again."""
        with suppress(ProcessLookupError):
            kill_group(child.pid)
        while not child.has_exited():
            time.sleep(0.001)
        with self._launching:
            self._children.discard(child.pid)
            return child.reap()

    def _cause(self, ended: Ended) -> ServiceError:
        if self._stopping:
            return LiveUnavailable("The service stops.")
        signal = ending_signal(ended.code)
        logger.warning("reader gone", code=ended.code, signal=signal)
        if signal in ("SIGXCPU", "SIGALRM"):
            return TooLarge(f"Reading the files takes more than {READING.cpu_seconds} s of CPU time. {_MORE}")
        return LiveUnavailable("The reader of files ended. Repeat the request.")

    def _unpacked(self, answer: tuple[AnswerHead, bytes], order: LiveOrder) -> bytes:
        head, body = answer
        if head.kind == "problem":
            raise propagated(body)
        if head.kind == "memory":
            raise TooLarge(f"Reading the files takes more than {READING.memory_mb} MB of memory. {_MORE}")
        if head.kind != "answer":
            reference = uuid.uuid4().hex[:12]
            logger.error("reading failed", entry=order.entry, reference=reference, log=self._log.name)
            raise Unexpected(reference)
        return body


def _heard(descriptor: int, end: float) -> tuple[AnswerHead, bytes] | None:
    """Return head and body of the answer before the instant `end`; None if there is none, or half of one."""
    pieces: list[bytes] = []
    length = 0
    while length <= MOST_ANSWER_BYTES + _LONGEST_HEAD:
        ready, _, _ = select.select([descriptor], [], [], max(end - time.monotonic(), 0.0))
        if not ready:
            return None
        piece = os.read(descriptor, _PIECE)
        if not piece:
            break
        pieces.append(piece)
        length += len(piece)
    line, _, body = b"".join(pieces).partition(b"\n")
    try:
        head = AnswerHead.from_line(line)
    except (ValueError, TypeError):
        return None
    return (head, body) if len(body) == head.length else None


AT_ONCE = 4
MOST_WAITING = 16
_AGAIN_S = 1


@dataclass(frozen=True)
class _Question:
    """What one caller waits for."""

    order: LiveOrder
    answer: Future[bytes] = field(default_factory=Future)


class ReadingPool:
    """Has files read, each by a process of its own.

    `data_directory`: where folders of readers and their logs are; folders that were left there are removed.
    """

    def __init__(self, data_directory: Path) -> None:
        self._home = data_directory / "reading"
        self._reader = _Reader(self._home, data_directory / "log")
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
