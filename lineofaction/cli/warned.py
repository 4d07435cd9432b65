"""Warnings of a verb: printed before its numbers, in its JSON, and by its exit code if it is strict."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any

Json = dict[str, Any]


@dataclass
class Warned:
    """The warnings of one verb, each once, in the order in which they came up."""

    form: str = "text"
    messages: dict[str, Json] = field(default_factory=dict)

    @property
    def warnings(self) -> list[Json]:
        """All of them."""
        return list(self.messages.values())


_current: ContextVar[Warned] = ContextVar("warned")


def begin(form: str) -> Warned:
    """Begin a verb that prints "text", "csv" or "json"; return what its warnings gather in."""
    warned = Warned(form)
    _current.set(warned)
    return warned


def warn(warnings: Iterable[Json]) -> None:
    """Gather warnings, and print those that are new: where people read, not into JSON or CSV."""
    warned = _current.get(None) or begin("text")
    for warning in warnings:
        if warning["message"] in warned.messages:
            continue
        warned.messages[warning["message"]] = warning
        if warned.form != "json":
            stream = sys.stdout if warned.form == "text" else sys.stderr
            print(f"warning ({warning['check']}): {warning['message']}", file=stream, flush=True)


def messages() -> list[str]:
    """Return what the verb has gathered, in words."""
    return [warning["message"] for warning in warnings_so_far()]


def warnings_so_far() -> list[Json]:
    """Return what the verb has gathered."""
    warned = _current.get(None)
    return [] if warned is None else warned.warnings
