"""One way out of every verb: results on standard output, one clear error on standard error, an exit code."""

from __future__ import annotations

import functools
import importlib
import inspect
import os
import sys
import traceback
import uuid
from collections.abc import Callable
from typing import Annotated, Any, NoReturn, ParamSpec, TypeVar

import typer

from lineofaction.cli.signature import parameters_of, with_parameters
from lineofaction.cli.warned import begin, warnings_so_far
from lineofaction.gearbox.problems import EXIT_INTERRUPTED, EXIT_WARNINGS, ServiceError, Unexpected

P = ParamSpec("P")
R = TypeVar("R")
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

    option = inspect.Parameter("strict", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Strict)
    return with_parameters(run, [*parameters_of(verb), option])


def guarded(verb: Callable[P, R]) -> Callable[P, R]:
    """Let `verb` end with an exit code and a message, never with a traceback."""

    @functools.wraps(verb)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        begin(next((name for name in ("json", "csv") if kwargs.get(name)), "text"))
        try:
            return verb(*args, **kwargs)
        except (typer.Exit, typer.Abort):
            raise
        except KeyboardInterrupt as stop:
            _leave("\n".join((str(stop) or "interrupted", *_notes(stop))), EXIT_INTERRUPTED)
        except BrokenPipeError:
            _close_pipe()
        except Exception as error:  # noqa: BLE001 (the last line of defense: logged by number below)
            known = _known(error)
            _leave(_text(known), known.exit_code)

    return run


def _known(error: Exception) -> ServiceError:
    """Return the error as one of our tree; a defect is written to a log under its reference."""
    if isinstance(error, ServiceError):
        return error
    translated = importlib.import_module("lineofaction.gearbox.convert.errors").translated(error)
    return translated if isinstance(translated, ServiceError) else _logged(error)


def _logged(error: Exception) -> Unexpected:
    """Write a defect to a log and return it by number."""
    directory = importlib.import_module("host.directories").cache_home() / "log"
    reference = uuid.uuid4().hex[:12]
    directory.mkdir(parents=True, exist_ok=True)
    file = directory / f"{reference}.log"
    file.write_text("".join(traceback.format_exception(error)), encoding="utf-8", errors="backslashreplace")
    return Unexpected(str(file))


def _text(error: ServiceError) -> str:
    """Return an error as lines: each fault on its own."""
    lines = [f"error: {line}" for line in (error.faults or (str(error),))]
    return "\n".join((*lines, *_notes(error)))


def _notes(error: BaseException) -> list[str]:
    return list(getattr(error, "__notes__", ()))


def _leave(text: str, code: int) -> NoReturn:
    """Say why, and end."""
    sys.stdout.flush()
    print(text, file=sys.stderr, flush=True)  # noqa: T201 (this is the command line)
    raise typer.Exit(code)


def _close_pipe() -> NoReturn:
    """End quietly when the reader of our output has gone (``loa ste ... | head``)."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    raise typer.Exit(0)
