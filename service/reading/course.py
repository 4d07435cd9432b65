"""Messages of a reader of files until it ends: the fields of the files that it reads, then the answer.

A file may end its reader, for example by a fault in a native library. The field that was sent last then names
the file.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from host import READING, Ended, ending_signal
from host.children.frames import Frame
from service.reading.child import FIELD, LONGEST_S, MAX_ANSWER_BYTES

MAX_BYTES = MAX_ANSWER_BYTES + 1_000_000
"""Most bytes of an answer and of the fields before it."""
_LONGEST_FIELD = 1_000
_KILL = "SIGKILL"


@dataclass
class Course:
    """State of a child's reading by the messages received so far."""

    field: str | None = None
    """Field of the file that was read last, "" before the first; None: no order was read."""
    answer: Frame | None = None
    """Answer of the child; None: none, a part of one, or one followed by further bytes."""
    overrun: str = ""
    """Name of the limit for which the reading was stopped; "": it was not stopped."""
    broken: bool = False
    """Whether the child has sent a message that no reader sends."""

    def take(self, frames: Iterable[Frame]) -> None:
        """Take the messages that the child has sent."""
        for frame in frames:
            names_field = frame.kind == FIELD
            too_long = names_field and len(frame.body) > _LONGEST_FIELD
            if self.broken or self.answer is not None or too_long:
                self.answer, self.broken = None, True
            elif names_field:
                self.field = frame.body.decode("utf-8", "replace")
            else:
                self.answer = frame

    def end(self, *, partial: bool, overrun: str = "") -> None:
        """Note the end of the messages; an answer that is partial or was stopped is dropped."""
        self.overrun = overrun
        if partial or overrun:
            self.answer = None

    def bound_of_end(self, ended: Ended) -> str:
        """Return the bound of the file that ended the child; "": no file ended it.

        A kill counts as one from outside, by an operator or by a system without memory. Exceptions are the
        kill by the follower of the child, at an overrun, and the kill of a process whose CPU time is used up.
        """
        signal = ending_signal(ended.code)
        if self.overrun or self.field is None:
            return self.overrun
        if signal == "SIGXCPU" or (signal == _KILL and ended.cpu_seconds >= READING.cpu_seconds):
            return f"read within {READING.cpu_seconds} s of CPU time"
        if signal == "SIGALRM":
            return f"read within {LONGEST_S} s"
        if signal == _KILL:
            return ""
        return f"a file that can be read; this one ended its reader ({signal or f'exit code {ended.code}'})"
