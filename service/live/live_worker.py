"""The live worker seen from the service: start, ask, stop an answer that nobody waits for, end."""

from __future__ import annotations

import threading
import time
import uuid
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import structlog

from host.children.child import Child
from host.children.frames import Frame
from host.children.launcher import start_child
from lineofaction.gearbox.problems import LiveUnavailable, ServiceError, Superseded, Unexpected
from service.folders import locked_folder, remove_left
from service.live.answer import propagated
from service.live.child import Share
from service.live.question_pool import STOP, QuestionPool
from service.live.turns import Limits, Question
from service.settings import MIN_MEMORY_MB, Settings
from service.worker.usage import machine_memory_mb

_LAUNCH = partial(start_child, "service.live.child")
_LOOK_S = 0.1
"""Time between two looks whether somebody still waits."""

logger = structlog.get_logger(__name__)
WORKERS = 3
"""Processes at most: one for submissions that wait for a predicted cost, two for all others."""
LIMITS = Limits(outstanding=64, in_all=512)


@dataclass(frozen=True)
class AnswerTimes:
    """Times after which an answer is given up, s."""

    longest_s: float = 60.0
    """Longest time for one answer, with the start of the worker."""
    obsolete_s: float = 1.0
    """Least time of an answer that became obsolete: a slider in motion still gets an answer now and then."""
    to_stop_s: float = 5.0
    """Time after which a worker that does not heed the stop is killed."""


class _WorkerGone(Exception):
    """The process ended, or did not answer in time."""

    def __init__(self, *, late: bool = False) -> None:
        super().__init__()
        self.late = late


class _LiveProcess:
    """One child process that answers one order after the other."""

    def __init__(self, log: Path, memory_limit_mb: int, home: Path) -> None:
        self._orders, self.has_answered = 0, False
        self._folder = ExitStack()
        drafts = self._folder.enter_context(locked_folder(home))
        try:
            with log.open("ab") as stream:
                self._child = Child(_LAUNCH, stream.fileno(), Path.cwd())
        except OSError:
            self._folder.close()
            raise
        # a child that has died already is noticed at the first question
        self._child.send(Share(memory_limit_mb, str(drafts)).frame())

    @property
    def pid(self) -> int:
        return self._child.pid

    @property
    def alive(self) -> bool:
        return not self._child.exits_within(0.0)

    def ask(self, question: Question, times: AnswerTimes) -> Frame:
        """Return the answer; stop the work on it where the question becomes obsolete.

        Raises `_WorkerGone`: the process ended or took too long, and must be replaced.
        """
        self._orders += 1
        self._send(question.order.frame())
        begin = time.monotonic()
        end, stopped = begin + times.longest_s, False
        while True:
            instant = time.monotonic()
            if instant >= end:
                raise _WorkerGone(late=True)
            if question.obsolete and not stopped and instant >= begin + times.obsolete_s:
                self._send(Frame.of_json("stop", self._orders))
                end, stopped = min(end, instant + times.to_stop_s), True
            for answer in self._child.receive(min(end - instant, _LOOK_S)):  # none or one
                self.has_answered = True
                return answer
            if self._child.closed:
                raise _WorkerGone

    def _send(self, order: Frame) -> None:
        if not self._child.send(order):
            raise _WorkerGone

    def end_group(self) -> None:
        """Kill the process and its children; `ask` then raises. Any thread may call this."""
        self._child.end_group()

    def close(self) -> None:
        """Kill and reap the process, close its pipes; called by the thread that asks, even twice."""
        self._child.end()
        self._folder.close()


class LiveWorker:
    """Answers questions by a child process, which it starts, watches, replaces and ends."""

    def __init__(self, data_directory: Path, memory_limit_mb: int, times: AnswerTimes | None = None) -> None:
        self._home, self._log = data_directory / "live", data_directory / "log" / "live.log"
        self._memory_limit_mb, self._times = memory_limit_mb, times or AnswerTimes()
        self._lock = threading.RLock()
        self._process: _LiveProcess | None = None
        self._stopping = False

    @property
    def pid(self) -> int | None:
        """Process id of the worker, None while there is none."""
        process = self._process
        return None if process is None else process.pid

    def answer(self, question: Question) -> bytes:
        """Return the JSON answer; see `QuestionWorker`."""
        try:
            answer = self._exchange(question)
        except _WorkerGone as gone:
            logger.warning("live worker gone", late=gone.late, entry=question.order.entry)
            self._end_process()
            raise self._cause(gone, question) from None
        if answer.kind == "problem":
            raise propagated(answer)
        if answer.kind == "stopped":
            raise _superseded()
        if answer.kind == "memory":
            self._end_process()
            may_have = f"it may have {self._memory_limit_mb} MB"
            raise LiveUnavailable(f"The live worker ran out of memory: {may_have}. Submit a job instead.")
        if answer.kind == "defect":
            reference = uuid.uuid4().hex[:12]
            logger.error(
                "live question failed", entry=question.order.entry, reference=reference, log=str(self._log)
            )
            raise Unexpected(reference)
        return answer.body

    def start(self) -> None:
        """Answer again after a stop; see `QuestionWorker`."""
        with self._lock:
            self._stopping = False

    def stop(self) -> None:
        """End the process in the middle of an answer; see `QuestionWorker`."""
        with self._lock:
            self._stopping = True
            if self._process is not None:
                self._process.end_group()

    def rest(self) -> None:
        """End the process; see `QuestionWorker`."""
        self._end_process()

    def close(self) -> None:
        """End the process; see `QuestionWorker`."""
        self._end_process()

    def _cause(self, gone: _WorkerGone, question: Question) -> Exception:
        if self._stopping:
            return LiveUnavailable(STOP)
        if question.obsolete:
            return _superseded()
        if gone.late:
            late = f"It took longer than {self._times.longest_s:g} s and was ended. Submit a job instead"
            return LiveUnavailable(f"{late}; repeat the request to continue the computation of a compliance.")
        return LiveUnavailable("The live worker ended. Repeat the request.")

    def _exchange(self, question: Question) -> Frame:
        """Return the answer; a process that has died since its last answer is replaced once."""
        process = self._ready()
        try:
            return process.ask(question, self._times)
        except _WorkerGone as gone:
            if gone.late or not process.has_answered:
                raise
        self._end_process()
        return self._ready().ask(question, self._times)

    def _ready(self) -> _LiveProcess:
        with self._lock:
            if self._stopping:
                raise LiveUnavailable(STOP)
            if self._process is not None and not self._process.alive:
                self._end_process()
            if self._process is None:
                self._log.parent.mkdir(parents=True, exist_ok=True)
                self._process = _LiveProcess(self._log, self._memory_limit_mb, self._home)
                logger.info("live worker started", pid=self._process.pid)
            return self._process

    def _end_process(self) -> None:
        with self._lock:
            process, self._process = self._process, None
            if process is not None:
                process.close()


def _superseded() -> ServiceError:
    return Superseded("A later request of the same caller replaced it.")


def live_pool(settings: Settings) -> QuestionPool:
    """Return the pool of live questions of a service; a worker may have as much memory as one computation."""
    share = settings.memory_limit_mb or machine_memory_mb() // settings.workers
    memory = max(share, MIN_MEMORY_MB)
    remove_left(settings.data_directory / "live")
    workers = [LiveWorker(settings.data_directory, memory) for _ in range(WORKERS)]
    return QuestionPool(workers, LIMITS, "live requests", for_submissions=1)
