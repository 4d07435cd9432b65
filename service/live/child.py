"""The live worker process: many short questions, one after the other, with what they share kept in memory.

Started as ``python -m service.live.child DESCRIPTOR MEMORY_MB`` in a session of its own. Orders are
lines on standard input; a line ``{"stop": N}`` stops the work on the Nth of them. When the input closes the
service is gone, and the whole process group is killed. Answers go to DESCRIPTOR. Standard error is the log.
"""

from __future__ import annotations

import _thread
import importlib
import json
import os
import queue
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from typing import TypeAlias

from pydantic_core import to_json

from host import kill_own_group, lower_priority
from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import ServiceError
from service.live.order import AnswerHead, Json, LiveOrder, LiveWork
from service.worker.usage import begin_work, hold_to

Note: TypeAlias = Callable[[], None]
Write: TypeAlias = Callable[[Json], bytes]
_NICENESS = 5
"""Less than that of jobs: somebody waits for the answer."""
translated = on_demand("lineofaction.gearbox.convert.errors:translated")


def main() -> None:
    """Answer until the service is gone or memory is out."""
    begin_work()
    lower_priority(_NICENESS)
    orders: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    stop = _Stop()
    signal.signal(signal.SIGINT, stop.heed)
    threading.Thread(target=_listen, args=(orders, stop), daemon=True).start()
    hold_to(int(sys.argv[2]))
    with os.fdopen(int(sys.argv[1]), "wb") as channel:
        head = AnswerHead("")
        while head.kind != "memory":
            head, body = stop.stoppable(LiveOrder.from_line(orders.get()))
            channel.write(head.line() + body)
            channel.flush()


def _listen(orders: queue.SimpleQueue[bytes], stop: _Stop) -> None:
    """Take orders from standard input; kill the process group when the service is gone."""
    with os.fdopen(0, "rb") as stream:
        for line in stream:
            if line.startswith(b'{"stop"'):
                stop.ask_for(json.loads(line)["stop"])
            else:
                orders.put(line)
    kill_own_group()


class _Stopped(BaseException):
    """The work is of no use any more; nothing but `_Stop` catches it."""


class _Stop:
    """Stops the work on one order in the main thread, and none that came after it."""

    def __init__(self) -> None:
        self._begun, self._at_work, self._asked = 0, False, 0

    def stoppable(self, order: LiveOrder) -> tuple[AnswerHead, bytes]:
        """Do the work on the next order."""
        self._begun += 1
        answer = AnswerHead("stopped"), b""
        try:
            self._at_work = True
            if self._asked != self._begun:
                answer = worked(order)
            self._at_work = False
        except _Stopped:
            pass
        return answer

    def ask_for(self, number: int) -> None:
        """Let the main thread stop the work on an order; from any thread."""
        self._asked = number
        _thread.interrupt_main()

    def heed(self, _signal: int, _frame: object) -> None:
        """Stop what is at work, if it is that order."""
        if self._at_work and self._asked == self._begun:
            self._at_work = False
            raise _Stopped


def written(answer: Json) -> bytes:
    """Return an answer as JSON, every number by the shortest decimals that give it.

    Raises `ValueError`: a number is not finite. Without memory for it the process ends: of small answers.
    """
    body: bytes = to_json(answer, inf_nan_mode="constants")
    if any(word in body for word in (b"NaN", b"Infinity")):
        json.dumps(answer, allow_nan=False)  # a text may have the word
    return body


def written_plainly(answer: Json) -> bytes:
    """Return the same, with a `MemoryError` where there is no memory for it."""
    return json.dumps(answer, allow_nan=False, separators=(",", ":")).encode()


def worked(
    order: LiveOrder, *further: object, note: Note = traceback.print_exc, write: Write = written
) -> tuple[AnswerHead, bytes]:
    """Do the work; the text of an exception leaves only if it was raised on purpose.

    Parameters
    ----------
    order : LiveOrder
    *further : object
        What the work is called with behind its inputs.
    note : callable
        Writes the exception being handled, a defect, into the log.
    write : callable
        Turns what the work returns into bytes.
    """
    try:
        module, _, name = order.entry.partition(":")
        work: LiveWork = getattr(importlib.import_module(module), name)
        answer = write(work(order.inputs, *further))
    except MemoryError:
        return AnswerHead("memory"), b""
    except Exception as error:  # noqa: BLE001 (a defect is logged by its traceback and reported by number)
        known = error if isinstance(error, ServiceError) else translated(error)
        if known is None:
            note()
            return AnswerHead("defect"), b""
        return problem(known)
    return AnswerHead("answer", len(answer)), answer


def problem(error: ServiceError) -> tuple[AnswerHead, bytes]:
    """Return head and body of an answer that is an error."""
    body = json.dumps(error.as_json()).encode()
    return AnswerHead("problem", len(body)), body


if __name__ == "__main__":
    main()
