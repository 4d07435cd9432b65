"""One way out of every verb: results on standard output, one clear error on standard error, an exit code."""

from __future__ import annotations

import functools
import os
import sys
import traceback
import uuid
from collections.abc import Callable
from typing import Annotated, Any, NoReturn, ParamSpec

import typer

from lineofaction.cli.verb_parameters import R, keyword, parameters_of, with_parameters
from lineofaction.cli.verb_warnings import STRICT, begin_warnings, in_lines, warnings_so_far
from lineofaction.gearbox.loading import load, on_demand
from lineofaction.gearbox.problems import EXIT_INTERRUPTED, EXIT_WARNINGS, ServiceError, Unexpected

P = ParamSpec("P")
_STRICT = "Exit with code 3 if a value is implausible, a part left out, or a tolerance not met."
Strict = Annotated[bool, typer.Option("--strict", help=_STRICT)]

translated = on_demand("lineofaction.gearbox.convert.errors:translated")


def computing(verb: Callable[..., R]) -> Callable[..., R]:
    """Give `verb` the option ``--strict``, by which its warnings decide its exit code; guard it.

    What it leaves in the cache is kept within the limit of `lineofaction.cli.cache`.
    """

    @functools.wraps(verb)
    def tidied(*args: Any, **kwargs: Any) -> R:
        answer = verb(*args, **kwargs)
        load("lineofaction.cli.cache:keep_small")()
        return answer

    guard = guarded(tidied)

    @functools.wraps(verb)
    def run(*args: Any, strict: bool = False, **kwargs: Any) -> R:
        STRICT.set(strict)
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
        begin_warnings(next((name for name in ("json", "csv") if kwargs.get(name)), "text"))
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


def _logged(error: Exception) -> Unexpected:
    """Return the error to print for a defect, and write the defect to a log under its reference."""
    directory = load("host.directories:cache_home")() / "log"
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
