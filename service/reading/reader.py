"""Questions about files of callers: a confined child in a temporary folder answers each.

Files of several callers are read at the same time, but only one of each caller; a second one waits, a third
is refused. So a caller with costly files delays no other. Children are forked from a *warm* process, which
has imported their modules.
"""

from __future__ import annotations

import threading
import time
import uuid
from importlib.util import find_spec
from pathlib import Path

import structlog

from host import LOOK_S, READING, Ended, ending_signal, missing_protections
from host.children.child import Child
from host.children.frames import Frame
from host.children.launcher import ChildProcess, Ends, Launcher, LauncherClosed
from host.children.watch import Watch
from lineofaction.gearbox.problems import BadInput, LiveUnavailable, ServiceError, Unexpected
from service.folders import locked_folder, remove_left
from service.live.answer import propagated
from service.live.order import LiveOrder
from service.live.question_pool import STOP, QuestionPool
from service.live.turns import Limits, Question
from service.reading.child import LONGEST_S
from service.reading.course import MAX_BYTES, Course
from service.reading.refusal import refusal

WORK = "service.reading.child"
"""Module whose function `work` a child executes."""
MODULES = (
    "lineofaction.gearbox.convert.errors",
    "lineofaction.gearbox.from_rexs.opened",
    "service.reading.child",
    "service.reading.texts",
    *filter(find_spec, ["service.reading.sheets"]),  # an instrument, which may be deleted
    "scipy.optimize",
)
"""Modules that the warm process imports."""
_WARM_WITHIN_S = 30.0
"""Time in which the warm process must have started, s."""
_PATIENCE_S = 2.0
"""Seconds beyond the child's time limit after which it is killed: the child ends first and states the reason.
"""

logger = structlog.get_logger(__name__)
AT_ONCE = 4
"""Number of questions that are answered at the same time."""
LIMITS = Limits(outstanding=2, in_all=20)
"""Most unanswered questions of one caller, and of all."""


class _Children:
    """Starts a child for each question, forked from a warm process if the system forks.

    Any thread may use it. Each child has a folder of its own below `home`.
    """

    def __init__(self, home: Path, logs: Path) -> None:
        self._home, self._log = home, logs / "reading.log"
        self._launcher = Launcher(WORK, MODULES, logs / "reading_warm.log", logger.warning)
        self._launching = threading.Lock()  # the launcher and its forked children are for one thread
        self._children: set[Child] = set()
        self._stopping = False

    def read(self, order: LiveOrder) -> bytes:
        """Return the JSON answer of a child that reads the files of the order.

        Raises the `ServiceError` that the child reports; `BadInput`: a file crashes the child, or exceeds its
        time, memory or bytes; `LiveUnavailable`: the child ended for another reason.
        """
        with locked_folder(self._home) as folder:
            child = self._started(folder)
            try:
                child.send(order.frame())  # no error for a dead child: its missing answer tells
                course = _followed_course(child, folder)
            finally:
                ended = self._end(child)
        if course.answer is None:
            raise self._cause(ended, course, order)
        return self._unpacked(course.answer, course, order)

    def start(self) -> None:
        """Start children for the questions again."""
        self._stopping = False
        self._launcher.open()

    def stop(self) -> None:
        """End all children and start no other; their callers get the error of a stop."""
        self._stopping = True
        self._launcher.hurry()
        for child in tuple(self._children):
            child.end_group()

    def close(self) -> None:
        """End the warm process, once no child is left."""
        self._launcher.close()

    def _started(self, folder: Path) -> Child:
        if self._stopping:
            raise LiveUnavailable(STOP)
        self._log.parent.mkdir(parents=True, exist_ok=True)
        try:
            with self._log.open("ab") as log, self._launching:
                child = Child(self._launch, log.fileno(), folder)
                self._children.add(child)
        except LauncherClosed:
            raise LiveUnavailable(STOP) from None
        except OSError:
            raise LiveUnavailable("The system starts no reader now. Try again soon.") from None
        if self._stopping:  # it began during a stop, which may not have seen it
            child.end_group()
        return child

    def _launch(self, ends: Ends) -> ChildProcess:
        return self._launcher.launch(ends, _WARM_WITHIN_S)

    def _end(self, child: Child) -> Ended:
        """Kill a child and its children, unless it has ended; return its status."""
        child.end_group()
        while not child.exits_within(_PATIENCE_S):
            pass
        with self._launching:
            self._children.discard(child)
            ended = child.end()
        assert ended is not None
        return ended

    def _cause(self, ended: Ended, course: Course, order: LiveOrder) -> ServiceError:
        """Return the error for a child that ended without an answer."""
        if self._stopping:
            return LiveUnavailable(STOP)
        signal = ending_signal(ended.code)
        logger.warning("reader gone", code=ended.code, signal=signal, field=course.field)
        bound = course.bound_of_end(ended)
        if not bound:
            return LiveUnavailable("The reader of files ended. Repeat the request.")
        return refusal(order.inputs, course.field or "", bound)

    def _unpacked(self, answer: Frame, course: Course, order: LiveOrder) -> bytes:
        """Return the JSON of an answer; raises the error that it reports."""
        if answer.kind == "problem":
            raise propagated(answer)
        if answer.kind == "memory":
            bound = f"read within {READING.memory_mb} MB of memory"
            raise refusal(order.inputs, course.field or "", bound)
        if answer.kind != "answer":
            reference = uuid.uuid4().hex[:12]
            logger.error("reading failed", entry=order.entry, reference=reference, log=self._log.name)
            raise Unexpected(reference)
        return answer.body


def _followed_course(child: Child, folder: Path) -> Course:
    """Return the course of a child until its end, or until it exceeds its time or its written bytes."""
    watch = Watch.begun(LONGEST_S + _PATIENCE_S, folder, READING)
    course, look, overrun = Course(), time.monotonic() + LOOK_S, ""
    while not child.closed and not overrun and child.received <= MAX_BYTES:
        course.take(child.receive(max(look - time.monotonic(), 0.0)))
        if time.monotonic() >= look and not child.closed:
            look = time.monotonic() + LOOK_S
            overrun = _overrun(child, watch)
    course.end(partial=child.partial, overrun=overrun)
    return course


def _overrun(child: Child, watch: Watch) -> str:
    """Return the limit that a child exceeds, "": none."""
    if watch.late:
        return f"read within {LONGEST_S} s"
    excess = watch.excess(child.pid)
    return f"read without {excess}" if excess else ""


class Reader:
    """Reads files for one question after the other, each in a new child; see `QuestionWorker`."""

    def __init__(self, children: _Children) -> None:
        self._children = children

    def answer(self, question: Question) -> bytes:
        """Return the JSON answer of the child; raises as `_Children.read`."""
        return self._children.read(question.order)

    def start(self) -> None:
        """Read again after a stop; see `QuestionWorker`."""
        self._children.start()

    def stop(self) -> None:
        """End all children and start no other; see `QuestionWorker`."""
        self._children.stop()

    def rest(self) -> None:
        """Leave the process that children are forked from to the other readers; see `QuestionWorker`."""

    def close(self) -> None:
        """End the process that children are forked from; see `QuestionWorker`."""
        self._children.close()


def require_confinement() -> None:
    """Raise `BadInput` where the system lacks a protection that confines the readers of files."""
    if missing := missing_protections():
        bound = f"left out on this system, which lacks protections of readers: {', '.join(missing)}"
        remedy = "Use Linux 5.13 or later with Landlock (boot parameter lsm) and seccomp, on x86-64 or ARM64."
        raise BadInput.of("require_confinement", True, bound, remedy)


def reading_pool(data_directory: Path) -> QuestionPool:
    """Return the pool of readers that answers questions about files of callers.

    The function of an order is called as ``function(inputs, folder, announce)``; it calls `announce` with the
    field of each file before it reads the file. `data_directory` has the folders of the readers and their
    logs; folders of earlier processes are removed.
    """
    home = data_directory / "reading"
    remove_left(home)
    if missing := missing_protections():
        logger.warning("this system does not confine the readers of files", missing=missing)
    children = _Children(home, data_directory / "log")
    return QuestionPool([Reader(children) for _ in range(AT_ONCE)], LIMITS, "files to read")
