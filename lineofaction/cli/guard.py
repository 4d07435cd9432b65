"""One way out of every verb: its warnings, one clear error on standard error, an exit code; interrupts."""

from __future__ import annotations

import functools
import importlib
import inspect
import os
import re
import signal
import sys
import threading
import traceback
import uuid
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from functools import wraps
from shutil import get_terminal_size
from textwrap import TextWrapper
from types import FrameType
from typing import IO, Annotated, Any, NoReturn, ParamSpec, TypeVar, get_type_hints

import typer

from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import EXIT_INTERRUPTED, EXIT_WARNINGS, ServiceError, Unexpected

R = TypeVar("R")


def with_parameters(verb: Callable[..., R], parameters: Sequence[inspect.Parameter]) -> Callable[..., R]:
    """Give a verb the signature that the command line reads."""
    verb.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    verb.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return verb


def parameters_of(verb: Callable[..., Any]) -> list[inspect.Parameter]:
    """Return the parameters of a verb, their annotations evaluated."""
    return list(inspect.signature(verb, eval_str=True).parameters.values())


def keyword(name: str, annotation: Any, default: Any = inspect.Parameter.empty) -> inspect.Parameter:
    """Return a parameter that the command line passes by its name."""
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def grouped(verb: Callable[..., R]) -> Callable[..., R]:
    """Spread parameters that are dataclasses: each of their fields is an option, annotated as one.

    The verb is called with the dataclasses.
    """
    own = parameters_of(verb)
    kinds = {part.name: part.annotation for part in own}
    groups = {name: kind for name, kind in kinds.items() if isinstance(kind, type) and is_dataclass(kind)}

    @wraps(verb)
    def run(**options: Any) -> R:
        for name, group in groups.items():
            options[name] = group(**{field.name: options.pop(field.name) for field in fields(group)})
        return verb(**options)

    parameters = [
        parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY)
        for part in own
        for parameter in (_options(groups[part.name]) if part.name in groups else [part])
    ]
    return with_parameters(run, parameters)


def _options(group: Any) -> list[inspect.Parameter]:
    hints = get_type_hints(group, include_extras=True)
    defaults = {
        field.name: inspect.Parameter.empty if field.default is MISSING else field.default
        for field in fields(group)
    }
    return [keyword(name, hints[name], default) for name, default in defaults.items()]


# Warnings of a verb: printed before its numbers, in its JSON, and by its exit code if it is strict.


Json = dict[str, Any]


@dataclass
class _Warned:
    """The warnings of one verb, each once, in the order in which they came up."""

    form: str = "text"
    messages: dict[str, Json] = field(default_factory=dict)


_current: ContextVar[_Warned] = ContextVar("warned")


def _begin(form: str) -> _Warned:
    """Begin a verb that prints "text", "csv" or "json"; return what its warnings gather in."""
    warned = _Warned(form)
    _current.set(warned)
    return warned


_UNIT = re.compile(r"(?: |\b)(?:N|kg|CPU) [ms](?![a-z])")
"""A unit of two words, and what is before it: lines break neither."""


def in_lines(text: str, room: IO[str] | int) -> str:
    """Break a text between words for a terminal or a width; longer words, as paths, and units stay whole."""
    if not isinstance(room, int):
        room = get_terminal_size().columns if room.isatty() else sys.maxsize
    fitted = TextWrapper(room, break_long_words=False, break_on_hyphens=False)
    lines = _UNIT.sub(lambda unit: unit[0].replace(" ", "\u00a0"), text).splitlines()
    broken = (line if len(line) <= room else fitted.fill(line) for line in lines)
    return "\n".join(broken).replace("\u00a0", " ")


def warn(warnings: Iterable[Json]) -> None:
    """Gather warnings, and print those that are new: where people read, not into JSON or CSV."""
    warned = _current.get(None) or _begin("text")
    for warning in warnings:
        if warning["message"] in warned.messages:
            continue
        warned.messages[warning["message"]] = warning
        if warned.form != "json":
            stream = sys.stdout if warned.form == "text" else sys.stderr
            text = f"warning ({warning['check']}): {warning['message']}"
            print(in_lines(text, stream), file=stream, flush=True)


def messages() -> list[str]:
    """Return what the verb has gathered, in words."""
    return [warning["message"] for warning in warnings_so_far()]


def warnings_so_far() -> list[Json]:
    """Return what the verb has gathered."""
    warned = _current.get(None)
    return [] if warned is None else list(warned.messages.values())


# Requests to stop: long work ends at its next safe place, at a second request and in services at once.


_SIGNALS = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def until_interrupted() -> Iterator[Callable[[], bool]]:
    """Yield what tells whether SIGINT or SIGTERM came; the second raises KeyboardInterrupt.

    Outside the main thread, where signals cannot be handled, it never does.
    """
    interrupted = threading.Event()

    def ask(_number: int, _frame: FrameType | None) -> None:
        if interrupted.is_set():
            raise KeyboardInterrupt
        interrupted.set()

    if threading.current_thread() is not threading.main_thread():
        yield interrupted.is_set
        return
    before = [signal.signal(number, ask) for number in _SIGNALS]
    try:
        yield interrupted.is_set
    finally:
        for number, handler in zip(_SIGNALS, before, strict=True):
            signal.signal(number, handler)


# One way out of every verb: results on standard output, one clear error on standard error, an exit code.


P = ParamSpec("P")
_STRICT = "Exit with code 3 if a value is implausible, a part left out, or a tolerance not met."
Strict = Annotated[bool, typer.Option("--strict", help=_STRICT)]


def computing(verb: Callable[..., R]) -> Callable[..., R]:
    """Give `verb` the option ``--strict``, by which its warnings decide its exit code; guard it.

    What it leaves in the cache is kept within the limit of `lineofaction.cli.cache`.
    """

    @functools.wraps(verb)
    def tidied(*args: Any, **kwargs: Any) -> R:
        answer = verb(*args, **kwargs)
        importlib.import_module("lineofaction.cli.cache").keep_small()
        return answer

    guard = guarded(tidied)

    @functools.wraps(verb)
    def run(*args: Any, strict: bool = False, **kwargs: Any) -> R:
        answer = guard(*args, **kwargs)
        count = len(warnings_so_far())
        if strict and count:
            _leave(f"error: {count} warning{'s' if count > 1 else ''} under --strict", EXIT_WARNINGS)
        return answer

    return with_parameters(run, [*parameters_of(verb), keyword("strict", Strict, False)])


def guarded(verb: Callable[P, R]) -> Callable[P, R]:
    """Let `verb` end with an exit code and a message, never with a traceback."""

    @functools.wraps(verb)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        _begin(next((name for name in ("json", "csv") if kwargs.get(name)), "text"))
        try:
            return verb(*args, **kwargs)
        except (typer.Exit, typer.Abort):
            raise
        except KeyboardInterrupt as stop:
            _leave("\n".join((str(stop) or "interrupted", *_notes(stop))), EXIT_INTERRUPTED)
        except BrokenPipeError:  # the reader of our output has gone (``loa ste ... | head``)
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise typer.Exit(0) from None
        except Exception as error:  # noqa: BLE001 (the last line of defense: logged by number below)
            known = error if isinstance(error, ServiceError) else translated(error) or _logged(error)
            lines = [f"error: {line}" for line in (known.faults or (str(known),))]
            _leave("\n".join((*lines, *_notes(known))), known.exit_code)

    return run


translated = on_demand("lineofaction.gearbox.convert.errors:translated")


def _logged(error: Exception) -> Unexpected:
    """Return what is said of a defect, which is written to a log under its reference."""
    directory = importlib.import_module("host.directories").cache_home() / "log"
    reference = uuid.uuid4().hex[:12]
    directory.mkdir(parents=True, exist_ok=True)
    file = directory / f"{reference}.log"
    file.write_text("".join(traceback.format_exception(error)), encoding="utf-8", errors="backslashreplace")
    return Unexpected(str(file))


def _notes(error: BaseException) -> list[str]:
    return list(getattr(error, "__notes__", ()))


def _leave(text: str, code: int) -> NoReturn:
    sys.stdout.flush()
    print(in_lines(text, sys.stderr), file=sys.stderr, flush=True)  # noqa: T201 (this is the command line)
    raise typer.Exit(code)
