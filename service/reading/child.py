"""The reader of foreign bytes: one order in, one answer out, then the end.

Started as ``python -m service.reading.child DESCRIPTOR``, or forked, in a session of its own and in a folder
that whoever started it removes. The order is on standard input. Before it is read the process gives up all
other files, the network and what is beyond its limits (`host.confine`). DESCRIPTOR gets, as answers, the
field of each file before it is read, and then the answer. Standard error is the log.
"""

from __future__ import annotations

import os
import sys
import traceback
from pathlib import Path
from typing import BinaryIO

from host import READING, confine, end_after, lower_priority, prepare_confinement
from lineofaction.gearbox.problems import TooLarge
from service.live.child import problem, worked, written_plainly
from service.live.order import AnswerHead, LiveOrder
from service.worker.usage import begin_work

LONGEST_S = 30
"""Time after which it ends, whatever it waits for."""
MOST_ANSWER_BYTES = 100_000_000
_NICENESS = 5


warm_up = prepare_confinement
"""What a process does from which children are forked."""


def work(descriptor: int) -> None:
    """Read what the order says; the answer goes to the descriptor."""
    begin_work()
    end_after(LONGEST_S)
    lower_priority(_NICENESS)
    confine(Path.cwd(), READING)
    with os.fdopen(descriptor, "wb") as channel:
        head, body = _answer(channel)
        channel.write(head.line() + body)


def _answer(channel: BinaryIO) -> tuple[AnswerHead, bytes]:
    def announce(field: str) -> None:
        text = field.encode()
        channel.write(AnswerHead("reading", len(text)).line() + text)
        channel.flush()  # the file may end this process

    try:
        order = LiveOrder.from_line(sys.stdin.buffer.read())
    except MemoryError:
        return AnswerHead("memory"), b""
    announce("")
    head, body = worked(order, Path.cwd(), announce, note=_note, write=written_plainly)
    if len(body) > MOST_ANSWER_BYTES:
        return problem(TooLarge(f"What the files hold has more than {MOST_ANSWER_BYTES} bytes as JSON."))
    return head, body


def _note() -> None:
    """Log where a defect is; its text may be the caller's bytes."""
    kind, _, trace = sys.exc_info()
    sys.stderr.writelines(["reading failed\n", *traceback.format_tb(trace), f"{kind}\n"])


if __name__ == "__main__":
    work(int(sys.argv[1]))
