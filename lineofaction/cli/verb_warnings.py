"""Warnings of a verb: printed before its numbers, in its JSON, and by its exit code if it is strict."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from contextvars import ContextVar
from dataclasses import dataclass, field
from shutil import get_terminal_size
from textwrap import TextWrapper
from typing import IO, Any

Json = dict[str, Any]

_current: ContextVar[_Warned] = ContextVar("warned")

_UNIT = re.compile(r"(?: |\b)(?:N|kg|CPU) [ms](?![a-z])")
"""Pattern of a unit of two words with the word before it; lines break neither."""


@dataclass
class _Warned:
    """The warnings of one verb, each once, in the order in which they came up."""

    form: str = "text"
    messages: dict[str, Json] = field(default_factory=dict)


def begin_warnings(form: str) -> _Warned:
    """Begin a verb that prints "text", "csv" or "json"; return the list that gathers its warnings."""
    warned = _Warned(form)
    _current.set(warned)
    return warned


def in_lines(text: str, room: IO[str] | int) -> str:
    """Break a text between words for a terminal or a width; longer words, as paths, and units stay whole."""
    if not isinstance(room, int):
        room = get_terminal_size().columns if room.isatty() else sys.maxsize
    fitted = TextWrapper(room, break_long_words=False, break_on_hyphens=False)
    lines = _UNIT.sub(lambda unit: unit[0].replace(" ", "\u00a0"), text).splitlines()
    broken = (line if len(line) <= room else fitted.fill(line) for line in lines)
    return "\n".join(broken).replace("\u00a0", " ")


def warn(warnings: Iterable[Json]) -> None:
    """Gather warnings, and print the new ones if people read the output, not into JSON or CSV."""
    warned = _current.get(None) or begin_warnings("text")
    for warning in warnings:
        if warning["message"] in warned.messages:
            continue
        warned.messages[warning["message"]] = warning
        if warned.form != "json":
            stream = sys.stdout if warned.form == "text" else sys.stderr
            text = f"warning ({warning['check']}): {warning['message']}"
            print(in_lines(text, stream), file=stream, flush=True)


def messages() -> list[str]:
    """Return the messages of the warnings that the verb has gathered."""
    return [warning["message"] for warning in warnings_so_far()]


def warnings_so_far() -> list[Json]:
    """Return the warnings that the verb has gathered."""
    warned = _current.get(None)
    return [] if warned is None else list(warned.messages.values())
