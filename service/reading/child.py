"""The reader of foreign bytes: one order in, one answer out, then the end.

Started as ``python -m service.reading.child DESCRIPTOR``, or forked, in a session of its own and in a folder
that whoever started it removes. The order is a frame on standard input. Before it is read the process gives
up all other files, the network and what is beyond its limits (`host.confine`). DESCRIPTOR gets frames: the
field of each file before it is read, and then the answer. Standard error is the log.
"""

from __future__ import annotations

import os
import sys
import traceback
from pathlib import Path
from typing import BinaryIO

from host import READING, confine, end_after, lower_priority, prepare_confinement
from host.children.frames import Frame, read_frame
from lineofaction.gearbox.problems import TooLarge
from service.live.answer import answer_of, json_body_or_memory_error, problem
from service.live.order import LiveOrder
from service.worker.usage import begin_work

LONGEST_S = 30
"""Seconds after which the reader ends, whatever it waits for."""
MAX_ANSWER_BYTES = 100_000_000
FIELD = "reading"
"""Kind of a message whose body is the field of the file that is read next."""
_NICENESS = 5


warm_up = prepare_confinement
"""Preparation of the process from which children are forked."""


def work(descriptor: int) -> None:
    """Read the files of the order; the answer goes to the descriptor."""
    begin_work()
    end_after(LONGEST_S)
    lower_priority(_NICENESS)
    confine(Path.cwd(), READING)
    with os.fdopen(descriptor, "wb") as channel:
        _answer(channel).write(channel)


def _answer(channel: BinaryIO) -> Frame:
    def announce(field: str) -> None:
        Frame(FIELD, field.encode()).write(channel)  # now: the file may end this process

    try:
        frame = read_frame(sys.stdin.buffer)
        if frame is None:
            sys.exit("The service closed the channel before it gave an order.")
        order = LiveOrder.from_frame(frame)
    except MemoryError:
        return Frame("memory")
    announce("")
    answer = answer_of(order, Path.cwd(), announce, note=_note, write=json_body_or_memory_error)
    if len(answer.body) > MAX_ANSWER_BYTES:
        return problem(TooLarge(f"What the files hold has more than {MAX_ANSWER_BYTES} bytes as JSON."))
    return answer


def _note() -> None:
    """Log where a defect is; its text may be the caller's bytes."""
    kind, _, trace = sys.exc_info()
    sys.stderr.writelines(["reading failed\n", *traceback.format_tb(trace), f"{kind}\n"])


if __name__ == "__main__":
    work(int(sys.argv[1]))
