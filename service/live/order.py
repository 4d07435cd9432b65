"""Messages between the service and its live worker: orders one way, answers the other.

An order is a line of JSON. An answer is a line of JSON, its head, and as many bytes as that says: the JSON
for the caller, which the service passes on without reading it.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

from lineofaction.gearbox.problems import ServiceError, last_part

Json = dict[str, Any]
LiveWork = Callable[..., Json]


class _Message:
    """A dataclass that is sent as a line of JSON."""

    def line(self) -> bytes:
        """Return the line."""
        return json.dumps(vars(self)).encode() + b"\n"

    @classmethod
    def from_line(cls, line: bytes) -> Self:
        """Read a line."""
        return cls(**json.loads(line))


@dataclass(frozen=True)
class LiveOrder(_Message):
    """One question for the live worker."""

    entry: str
    """``"module:function"``, called as ``function(inputs)``; it returns plain JSON."""
    inputs: Json
    """Plain JSON."""


@dataclass(frozen=True)
class AnswerHead(_Message):
    """The header before the bytes of an answer."""

    kind: str
    """"answer"; "problem": the bytes are problem details; "reading", before the answer: the bytes are the
    field of the file that is read next; the others have no bytes: "defect": the log says more; "stopped":
    whoever asked wants it no more; "memory": none was left, and the worker ends.
    """
    length: int = 0
    """Number of bytes that follow."""


# An error of another process, reported as that process reported it.


class _PropagatedError(ServiceError):
    """A problem as the live worker found it."""

    def __init__(self, facts: dict[str, Any]) -> None:
        self._facts = facts
        super().__init__(str(facts["detail"]))

    @property
    def kind(self) -> str:
        return last_part(str(self._facts["type"]))

    def as_json(self) -> dict[str, Any]:
        return self._facts


def propagated(body: bytes) -> _PropagatedError:
    """Return the error in the problem details `body`."""
    return _PropagatedError(json.loads(body))
