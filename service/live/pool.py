"""The pool of the live worker: questions that are answered while their caller waits, and answers kept.

A question under the name of a caller makes the caller's earlier one obsolete if that has not begun: a slider
that moves on asks for where it is now. The worker starts with the first question, is replaced when it dies or
takes too long, and ends when nothing was requested for a while.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import select
import subprocess
import sys
import threading
import time
import uuid
from collections import OrderedDict
from concurrent.futures import Future
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import structlog

from host import child_environment, kill_group
from lineofaction.gearbox.problems import LiveUnavailable, QueueFull, Superseded, Unexpected
from service.folders import evict, own_folder, remove_left
from service.live.order import AnswerHead, LiveOrder, propagated
from service.settings import LEAST_MEMORY_MB, Settings
from service.store.files import PARTIAL
from service.worker.usage import machine_memory_mb

# The live worker seen from the service: start, ask, end.


_PIECE = 1 << 16


class _WorkerGone(Exception):
    """The process ended, or did not answer in time."""

    def __init__(self, *, late: bool = False) -> None:
        super().__init__()
        self.late = late


class _LiveWorker:
    """One child process that answers one order after the other, leader of a session of its own."""

    def __init__(self, log: Path, memory_limit_mb: int, home: Path) -> None:
        self._rest = b""
        self._folder = ExitStack()
        drafts = self._folder.enter_context(own_folder(home))
        self.has_answered = False
        self._channel, theirs = os.pipe()
        try:
            with log.open("wb") as stream:
                self._process = subprocess.Popen(
                    [sys.executable, "-m", "service.live.child", str(theirs), str(memory_limit_mb)],
                    stdin=subprocess.PIPE,
                    stdout=stream,
                    stderr=stream,
                    pass_fds=(theirs,),
                    start_new_session=True,
                    env=child_environment(TMPDIR=str(drafts)),
                )
        except OSError:
            os.close(self._channel)
            self._folder.close()
            raise
        finally:
            os.close(theirs)

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def alive(self) -> bool:
        return self._process.poll() is None

    def ask(self, order: LiveOrder, limit_s: float) -> tuple[str, bytes]:
        """Return kind and bytes of the answer.

        Raises `_WorkerGone`: the process ended or took longer than `limit_s`; it is of no more use.
        """
        end = time.monotonic() + limit_s
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(order.line())
            self._process.stdin.flush()
        except BrokenPipeError:
            raise _WorkerGone from None
        while b"\n" not in self._rest:
            self._rest += self._piece(end)
        line, _, self._rest = self._rest.partition(b"\n")
        head = AnswerHead.from_line(line)
        pieces, missing = [self._rest], head.length - len(self._rest)
        while missing > 0:
            pieces.append(self._piece(end))
            missing -= len(pieces[-1])
        body, self._rest = b"".join(pieces), b""
        self.has_answered = True
        return head.kind, body

    def _piece(self, end: float) -> bytes:
        ready, _, _ = select.select([self._channel], [], [], max(end - time.monotonic(), 0.0))
        if not ready:
            raise _WorkerGone(late=True)
        piece = os.read(self._channel, _PIECE)
        if not piece:
            raise _WorkerGone
        return piece

    def end_group(self) -> None:
        """Kill the process and what it started; whoever asks it is told that it is gone. Any thread may."""
        if self._process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                kill_group(self.pid)

    def close(self) -> None:
        """Kill, reap, close the pipes; by the thread that asks. Idempotent."""
        self.end_group()
        self._process.wait()
        self._folder.close()
        if self._process.stdin is not None:
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.close()
        if self._channel >= 0:
            os.close(self._channel)
            self._channel = -1


logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class LiveLimits:
    """Bounds of the pool.

    Attributes
    ----------
    waiting : int
        Questions that may wait; beyond it they are refused.
    answer_s : float
        Longest time for one answer, with the start of the worker.
    idle_s : float
        Time without a question after which the worker ends.
    """

    waiting: int = 16
    answer_s: float = 60.0
    idle_s: float = 600.0


@dataclass(frozen=True)
class _Question:
    """The live request that one caller waits for."""

    order: LiveOrder
    future: Future[bytes] = field(default_factory=Future)


class LivePool:
    """Passes questions to the one live worker, which it starts, watches and ends."""

    def __init__(
        self,
        data_directory: Path,
        memory_limit_mb: int,
        limits: LiveLimits | None = None,
    ) -> None:
        self._home, self._log = data_directory / "live", data_directory / "log" / "live.log"
        self._memory_limit_mb, self._limits = memory_limit_mb, limits or LiveLimits()
        self._waiting: OrderedDict[str, _Question] = OrderedDict()
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None
        self._worker: _LiveWorker | None = None
        self._stopping = False
        remove_left(self._home)

    @classmethod
    def of(cls, settings: Settings) -> LivePool:
        """Return the pool of a service; its worker may have as much memory as one computation."""
        share = settings.memory_limit_mb or machine_memory_mb() // settings.workers
        return cls(settings.data_directory, max(share, LEAST_MEMORY_MB))

    @property
    def worker_pid(self) -> int | None:
        """Process id of the worker, None while there is none."""
        worker = self._worker
        return None if worker is None else worker.pid

    def ask(self, order: LiveOrder, caller: str | None = None) -> Future[bytes]:
        """Enter a question; the future holds the bytes of its JSON answer, or the error.

        Raises `QueueFull`: too many wait.
        """
        name = caller or uuid.uuid4().hex
        question = _Question(order)
        with self._changed:
            older = self._waiting.pop(name, None)
            if older is None and len(self._waiting) >= self._limits.waiting:
                text = f"{self._limits.waiting} live requests wait already. Try again soon."
                raise QueueFull.after(1, text)
            if older is not None:
                _refuse(older, Superseded("A later request of the same caller replaced it."))
            self._waiting[name] = question
            if self._thread is None:
                self._stopping = False
                self._thread = threading.Thread(target=self._loop, name="live pool", daemon=True)
                self._thread.start()
            self._changed.notify()
        return question.future

    def stop(self) -> None:
        """Refuse what waits, end the worker and the thread."""
        with self._changed:
            thread, self._stopping = self._thread, True
            for question in self._waiting.values():
                _refuse(question, LiveUnavailable("The service stops."))
            self._waiting.clear()
            if self._worker is not None:
                self._worker.end_group()
            self._changed.notify()
        if thread is not None:
            thread.join()

    def _loop(self) -> None:
        while (question := self._next()) is not None:
            if question.future.set_running_or_notify_cancel():
                self._settle(question)

    def _next(self) -> _Question | None:
        """Return the question that has waited longest; None, the worker ended, when stopped or idle."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._stopping, self._limits.idle_s)
            if self._waiting:
                return self._waiting.popitem(last=False)[1]
            self._end_worker()
            self._thread = None
            return None

    def _settle(self, question: _Question) -> None:
        try:
            question.future.set_result(self._answer(question.order))
        except _WorkerGone as gone:
            logger.warning("live worker gone", late=gone.late, entry=question.order.entry)
            self._end_worker()
            question.future.set_exception(LiveUnavailable(self._told(gone)))
        except Exception as error:  # noqa: BLE001 (whoever asked is told)
            question.future.set_exception(error)

    def _told(self, gone: _WorkerGone) -> str:
        if self._stopping:
            return "The service stops."
        if gone.late:
            late = f"It took longer than {self._limits.answer_s:g} s and was ended. Submit a job instead"
            return f"{late}; repeat the request to continue the computation of a compliance."
        return "The live worker ended. Repeat the request."

    def _answer(self, order: LiveOrder) -> bytes:
        kind, body = self._asked(order)
        if kind == "problem":
            raise propagated(body)
        if kind == "memory":
            self._end_worker()
            may_have = f"it may have {self._memory_limit_mb} MB"
            raise LiveUnavailable(f"The live worker ran out of memory: {may_have}. Submit a job instead.")
        if kind == "defect":
            reference = uuid.uuid4().hex[:12]
            logger.error("live question failed", entry=order.entry, reference=reference, log=str(self._log))
            raise Unexpected(reference)
        return body

    def _asked(self, order: LiveOrder) -> tuple[str, bytes]:
        """Return kind and bytes of the answer; a worker that ended since its last answer is replaced once."""
        worker = self._ready()
        try:
            return worker.ask(order, self._limits.answer_s)
        except _WorkerGone as gone:
            if gone.late or not worker.has_answered:
                raise
        self._end_worker()
        return self._ready().ask(order, self._limits.answer_s)

    def _ready(self) -> _LiveWorker:
        with self._changed:
            if self._stopping:
                raise LiveUnavailable("The service stops.")
            if self._worker is not None and not self._worker.alive:
                self._end_worker()
            if self._worker is None:
                self._log.parent.mkdir(parents=True, exist_ok=True)
                self._worker = _LiveWorker(self._log, self._memory_limit_mb, self._home)
                logger.info("live worker started", pid=self._worker.pid)
            return self._worker

    def _end_worker(self) -> None:
        with self._changed:
            worker, self._worker = self._worker, None
            if worker is not None:
                worker.close()


def _refuse(question: _Question, error: Exception) -> None:
    if question.future.set_running_or_notify_cancel():
        question.future.set_exception(error)


# Answers that are kept: they depend on stored results and on this program only.


MOST_BYTES = 200_000_000


class KeptAnswers:
    """Bodies of answers in a folder, by tag; what was not used for longest goes first.

    Parameters
    ----------
    folder : Path
        Made with the first answer. Several processes may use it at once.
    most_bytes : int
        What it holds at most.
    """

    def __init__(self, folder: Path, most_bytes: int = MOST_BYTES) -> None:
        self._folder, self._most_bytes = folder, most_bytes

    def find(self, tag: str) -> bytes | None:
        """Return the body of a tag, None if it is not kept."""
        path = self._path(tag)
        try:
            body = path.read_bytes()
            os.utime(path)
        except OSError:
            return None
        return body

    def keep(self, tag: str, body: bytes) -> None:
        """Keep a body; where that is impossible it is computed again."""
        path = self._path(tag)
        draft = path.with_name(f"{path.name}.{uuid.uuid4().hex[:8]}{PARTIAL}")
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            draft.write_bytes(body)
            draft.replace(path)
            evict(self._folder, self._most_bytes)
        except OSError as error:
            with contextlib.suppress(OSError):
                draft.unlink()
            logger.warning("answer not kept", error=str(error))

    def _path(self, tag: str) -> Path:
        return self._folder / f"{hashlib.sha256(tag.encode()).hexdigest()}.json"
