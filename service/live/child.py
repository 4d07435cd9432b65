"""The live worker process: many short questions one after the other, with shared state in memory.

Started as ``python -m service.live.child DESCRIPTOR`` in a session of its own. Orders are frames on standard
input: first its `Share`, then questions; one of the kind "stop" stops the work on one of them, by its number.
When the input closes the service is gone, and the whole process group is killed. Answers go to DESCRIPTOR.
Standard error is the log.
"""

from __future__ import annotations

import _thread
import os
import queue
import signal
import sys
import tempfile
import threading
from dataclasses import dataclass
from types import FrameType
from typing import BinaryIO

from host import kill_process_group, lower_priority
from host.children.frames import Frame, read_frame
from service.live.answer import answer_of
from service.live.order import LiveOrder
from service.worker.usage import begin_work, hold_to

_NICENESS = 5
"""Niceness of live workers, less than that of jobs: somebody waits for the answer."""
_IMPORT_S = 0.05
"""Time after which a stop that met an import is asked for again."""
_IMPORTS = "importlib._bootstrap"
"""Module that every import runs through."""


@dataclass(frozen=True)
class Share:
    """Share of the machine that a live worker has."""

    memory_mb: int
    drafts: str
    """Folder of the worker's temporary files, which the service removes however the worker ends."""

    def frame(self) -> Frame:
        """Return the message that carries it."""
        return Frame.of_json("share", vars(self))


def work(descriptor: int) -> None:
    """Answer until the service is gone or memory is out."""
    begin_work()
    lower_priority(_NICENESS)
    orders: queue.SimpleQueue[Frame] = queue.SimpleQueue()
    stop = _Stop()
    signal.signal(signal.SIGINT, stop.heed)
    stream = os.fdopen(0, "rb")
    first = read_frame(stream)
    if first is None:
        sys.exit("The service closed the channel before it gave an order.")
    share = Share(**first.as_json())
    os.environ["TMPDIR"] = tempfile.tempdir = share.drafts
    threading.Thread(target=_listen, args=(stream, orders, stop), daemon=True).start()
    hold_to(share.memory_mb)
    with os.fdopen(descriptor, "wb") as channel:
        answer = Frame("")
        while answer.kind != "memory":
            answer = stop.stoppable(orders.get())
            answer.write(channel)


def _listen(stream: BinaryIO, orders: queue.SimpleQueue[Frame], stop: _Stop) -> None:
    """Take orders from standard input; kill the process group when the service is gone."""
    while (frame := read_frame(stream)) is not None:
        if frame.kind == "stop":
            stop.ask_for(frame.as_json())
        else:
            orders.put(frame)
    kill_process_group()


class _Stopped(BaseException):
    """The service wants no answer to the order in work; `_Stop` alone catches this."""


class _Stop:
    """Stops the work on one order in the main thread, and on no later one.

    Orders have numbers from 1 in the order in which they arrive.
    """

    def __init__(self) -> None:
        self._begun = 0  # number of the order in work, or of the last one
        self._at_work = False
        self._requested = 0  # number of the order to stop

    def stoppable(self, order: Frame) -> Frame:
        """Do the work on the next order; return its answer, or one of the kind "stopped"."""
        self._begun += 1
        answer = Frame("stopped")
        try:
            self._at_work = True
            if self._requested != self._begun:
                answer = answer_of(LiveOrder.from_frame(order))
            self._at_work = False
        except _Stopped:
            pass
        return answer

    def ask_for(self, number: int) -> None:
        """Let the main thread stop the work on an order; from any thread."""
        self._requested = max(self._requested, number)
        _thread.interrupt_main()

    def heed(self, _signal: int, frame: FrameType | None) -> None:
        """Stop the work in progress, if it is on that order; an import in progress ends first.

        A package whose import is broken off stays half loaded, and no later import of it succeeds.
        """
        if not (self._at_work and self._requested == self._begun):
            return
        if _imports(frame):
            threading.Timer(_IMPORT_S, self.ask_for, (self._requested,)).start()
            return
        self._at_work = False
        raise _Stopped


def _imports(frame: FrameType | None) -> bool:
    """Whether a frame is within an import."""
    while frame is not None:
        if frame.f_globals.get("__name__") == _IMPORTS:
            return True
        frame = frame.f_back
    return False


if __name__ == "__main__":
    work(int(sys.argv[1]))
