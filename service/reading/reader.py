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
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import structlog

from host import READING, Ended, ending_signal, kill_group, missing_protections
from lineofaction.gearbox.problems import LiveUnavailable, ServiceError, TooLarge, Unexpected
from service.folders import own_folder, remove_left
from service.live.order import AnswerHead, LiveOrder, propagated
from service.live.question_pool import QuestionPool
from service.live.turns import Limits, Question
from service.reading.child import LONGEST_S, MOST_ANSWER_BYTES
from service.worker.forks import ChildProcess, Ends, Forks

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


class _Children:
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


class Reader:
    """Has files read for one question after the other, each by a child of its own; see `QuestionWorker`."""

    def __init__(self, children: _Children) -> None:
        self._children = children

    def answer(self, question: Question) -> bytes:
        """Return the JSON answer of the child; raises as `_Children.read`."""
        return self._children.read(question.order)

    def stop(self) -> None:
        """End all children; see `QuestionWorker`."""
        self._children.stop()

    def rest(self) -> None:
        """Leave the process that children are forked from to the other readers; see `QuestionWorker`."""

    def close(self) -> None:
        """End the process that children are forked from; see `QuestionWorker`."""
        self._children.close()


AT_ONCE = 4
LIMITS = Limits(held=2, in_all=20)


def reading_pool(data_directory: Path) -> QuestionPool:
    """Return the pool that has files of callers read.

    Works of its orders are called as ``function(inputs, folder)``. `data_directory`: where folders of readers
    and their logs are; folders that were left there are removed.
    """
    home = data_directory / "reading"
    remove_left(home)
    if missing := missing_protections():
        logger.warning("this system does not confine the readers of files", missing=missing)
    children = _Children(home, data_directory / "log")
    return QuestionPool([Reader(children) for _ in range(AT_ONCE)], LIMITS, "files to read")
