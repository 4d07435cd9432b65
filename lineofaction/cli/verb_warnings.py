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

STRICT: ContextVar[bool] = ContextVar("strict", default=False)
"""Whether warnings decide the exit code of the verb."""
_current: ContextVar[_VerbWarnings] = ContextVar("warned")

_UNIT = re.compile(r"(?: |\b)(?:N|kg|CPU) [ms](?![a-z])")
"""Pattern of a unit of two words, such as " N m", with the space before it; no line breaks at these spaces.
"""
_NO_BREAK_SPACE = "\u00a0"


@dataclass
class _VerbWarnings:
    """The warnings of one verb, each once, in the order in which they came up."""

    form: str = "text"
    """Format of the output of the verb: "text", "csv" or "json"."""
    messages: dict[str, Json] = field(default_factory=dict)
    """Warnings by their messages."""


def begin_warnings(form: str) -> _VerbWarnings:
    """Begin a verb that prints "text", "csv" or "json"; return the record that gathers its warnings."""
    gathered = _VerbWarnings(form)
    _current.set(gathered)
    return gathered


def in_lines(text: str, target: IO[str] | int) -> str:
    """Break a text between words for a stream or a width; longer words, as paths, and units stay whole.

    Only a stream that is a terminal has a width: for a file or a pipe the text stays as it is.
    """
    if isinstance(target, int):
        width = target
    else:
        width = get_terminal_size().columns if target.isatty() else sys.maxsize
    wrapper = TextWrapper(width, break_long_words=False, break_on_hyphens=False)
    lines = _UNIT.sub(lambda unit: unit[0].replace(" ", _NO_BREAK_SPACE), text).splitlines()
    broken = (line if len(line) <= width else wrapper.fill(line) for line in lines)
    return "\n".join(broken).replace(_NO_BREAK_SPACE, " ")


def warn(warnings: Iterable[Json]) -> None:
    """Gather warnings, and print the new ones: with text to stdout, with CSV to stderr, never with JSON."""
    gathered = _current.get(None) or begin_warnings("text")
    for warning in warnings:
        if warning["message"] in gathered.messages:
            continue
        gathered.messages[warning["message"]] = warning
        if gathered.form != "json":
            stream = sys.stdout if gathered.form == "text" else sys.stderr
            text = f"warning ({warning['check']}): {warning['message']}"
            print(in_lines(text, stream), file=stream, flush=True)


def messages() -> list[str]:
    """Return the messages of the warnings that the verb has gathered."""
    return [warning["message"] for warning in warnings_so_far()]


def warnings_so_far() -> list[Json]:
    """Return the warnings that the verb has gathered."""
    gathered = _current.get(None)
    return [] if gathered is None else list(gathered.messages.values())
