"""Messages between the service and its live worker: orders one way, answers the other.

An order is a line of JSON. An answer is a line of JSON, its head, and as many bytes as that says: the JSON
for the caller, which the service passes on without reading it.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from lineofaction.gearbox.problems import ServiceError, last_part

Json = dict[str, Any]
LiveWork = Callable[..., Json]


@dataclass(frozen=True)
class LiveOrder:
    """One question for the live worker.

    Attributes
    ----------
    entry : str
        ``"module:function"``, called as ``function(inputs)``; it returns plain JSON.
    inputs : dict
        Plain JSON.
    """

    entry: str
    inputs: Json

    def line(self) -> bytes:
        """Return the order as one line of JSON."""
        return json.dumps({"entry": self.entry, "inputs": self.inputs}).encode() + b"\n"

    @classmethod
    def from_line(cls, line: bytes) -> LiveOrder:
        """Read the line of an order."""
        return cls(**json.loads(line))


@dataclass(frozen=True)
class AnswerHead:
    """The header before the bytes of an answer.

    Attributes
    ----------
    kind : str
        "answer"; "problem": the bytes are problem details; "defect": the log says more, there are no bytes;
        "memory": none was left, there are no bytes, and the worker ends.
    length : int
        Number of bytes that follow.
    """

    kind: str
    length: int = 0

    def line(self) -> bytes:
        """Return the head as one line of JSON."""
        return json.dumps({"kind": self.kind, "length": self.length}).encode() + b"\n"

    @classmethod
    def from_line(cls, line: bytes) -> AnswerHead:
        """Read the line of a head."""
        return cls(**json.loads(line))


# An error of another process, reported as that process reported it.


class _PropagatedError(ServiceError):
    """A problem as the live worker found it."""

    def __init__(self, facts: dict[str, Any]) -> None:
        self._facts = facts
        super().__init__(str(facts["detail"]))

    @property
    def kind(self) -> str:
        """Last part of the type of the problem that came."""
        return last_part(str(self._facts["type"]))

    def as_json(self) -> dict[str, Any]:
        """Return the problem details as they came."""
        return self._facts


def propagated(body: bytes) -> _PropagatedError:
    """Return the error in the problem details `body`."""
    return _PropagatedError(json.loads(body))
