"""What a reader of files sends until it ends: the fields of the files that it reads, then the answer.

A file may end its reader, as a native library does that it leads astray. Then the field that was sent last
names the file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Self

from host import READING, Ended, ending_signal
from lineofaction.gearbox.problems import BadInput
from service.live.order import AnswerHead
from service.reading.child import LONGEST_S, MOST_ANSWER_BYTES

MOST_BYTES = MOST_ANSWER_BYTES + 1_000_000
"""Of an answer and of the fields before it."""
_LONGEST_HEAD, _LONGEST_FIELD = 200, 1_000
_KILL = "SIGKILL"
Answer = tuple[AnswerHead, bytes]
"""Head and body."""

_TEXTS = ("toml", "csv", "rexs_base64")
_SHOWN = 20
_ADVICE = (
    "Export it again, or heal it in the program that wrote it; if it is large, leave out what is not needed."
)


@dataclass(frozen=True)
class Course:
    """How a child has read."""

    field: str | None
    """That of the file that was read last, "" before the first; None: no order was read."""
    answer: Answer | None
    """None: there is none, or a part of one."""
    overrun: str = ""
    """What the reading should have stayed within when it was stopped; "" if it was not."""

    @classmethod
    def of(cls, sent: bytes, overrun: str = "") -> Self:
        """Return the course of a child that has sent these bytes."""
        field, start = None, 0
        while (end := sent.find(b"\n", start, start + _LONGEST_HEAD)) >= 0:
            try:
                head = AnswerHead.from_line(sent[start:end])
                start = end + 1 + head.length
            except (ValueError, TypeError):
                break
            if head.kind != "reading":
                whole = len(sent) == start and not overrun
                return cls(field, (head, sent[end + 1 :]) if whole else None, overrun)
            if not 0 <= head.length <= _LONGEST_FIELD:
                break
            field = sent[end + 1 : start].decode("utf-8", "replace")
        return cls(field, None, overrun)

    def bound_of_end(self, ended: Ended) -> str:
        """Return what a file should have been that a child ended over; "" if no file ended it.

        A kill comes from outside, by the system that lacks memory or by its operator; but for that of whoever
        follows the child, and that of a process at the end of its CPU time.
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


# Which of the files or texts of an order it was.


def refusal(inputs: Mapping[str, Any], field: str, bound: str) -> BadInput:
    """Return the refusal of the file in a field of the inputs, or of the text in them where that has none."""
    sources = dict(_sources(inputs))
    texts = [name for name in sources if name.rpartition(".")[2] in _TEXTS]
    name = field if field in sources else next(iter([*texts, *sources]), "inputs")
    return BadInput.of(name, sources.get(name), bound, _ADVICE)


def _sources(value: object, path: str = "") -> Iterator[tuple[str, str]]:
    """Yield the field of every file or text that is read, and the name of the file or how the text begins."""
    if isinstance(value, dict):
        if isinstance(value.get("name"), str) and isinstance(value.get("content"), str):
            yield path, value["name"]
            return
        for key, part in value.items():
            inside = f"{path}.{key}" if path else str(key)
            if key in _TEXTS and isinstance(part, str):
                yield inside, part[:_SHOWN]
            else:
                yield from _sources(part, inside)
    elif isinstance(value, list):
        for index, part in enumerate(value):
            yield from _sources(part, f"{path}[{index}]")
