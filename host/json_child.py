"""A child process that gets one JSON object on standard input and answers with one on standard output."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from host.confinement import LOOK_S, Limits, excess
from host.directories import ENVIRONMENT
from host.sessions import ending_signal

# The threads that libraries of linear algebra start in a process.

ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
"""Environment of a process that computes in one thread.

Matrices of a few hundred rows gain nothing by more: threads that wait for each other keep processors busy.
"""

_ROOT = str(Path(__file__).resolve().parents[1])
INHERITED = (
    *("PATH", "HOME", "USER", "LOGNAME", "LANG", "LANGUAGE", "LC_*", "TZ", "TMPDIR", "TEMP", "TMP"),
    *("LD_LIBRARY_PATH", "DYLD_*", "PYTHON*", "VIRTUAL_ENV", "COVERAGE_*", "MPL*", "XDG_CACHE_HOME"),
    *("OMP_*", "OPENBLAS_*", "MKL_*", "VECLIB_*", "BLIS_*", "NUMBA_*", "DASK_*", "SSL_CERT_*"),
    *("AWS_ENDPOINT*", "AWS_REGION", "AWS_DEFAULT_REGION", "AWS_ROLE_*", "AWS_WEB_IDENTITY_TOKEN_FILE"),
    *("SYSTEMROOT", "SYSTEMDRIVE", "WINDIR", "COMSPEC", "PATHEXT", "USERPROFILE", "APPDATA", "LOCALAPPDATA"),
    f"{ENVIRONMENT}*",
)
"""Variables that children inherit, with ``*`` for any ending: none of them holds a secret."""
_NO_MEMORY = ("MemoryError", "bad_alloc")
"""How Python and C++ say that an allocation failed."""


def keep_to_one_thread() -> None:
    """Let libraries that are not loaded yet start no threads, where the environment does not say how many."""
    if not any(name in os.environ for name in ONE_THREAD):
        os.environ.update(ONE_THREAD)


# What a child process gets of this one's environment: what it needs to compute, and no secrets.


def child_environment(**further: str) -> dict[str, str]:
    """Return the environment of a child: one thread, modules found where we find them, installed or not.

    Parameters
    ----------
    **further : str
        Variables beside those inherited.
    """
    inherited = {
        name: value
        for name, value in os.environ.items()
        if any(fnmatchcase(name.upper(), pattern) for pattern in INHERITED)
    }
    modules = os.pathsep.join(filter(None, (os.environ.get("PYTHONPATH"), _ROOT)))
    return inherited | ONE_THREAD | {"PYTHONPATH": modules} | further


class ChildFailed(Exception):
    """A child failed, was killed, ran out of time or answered nonsense; the message says which.

    Parameters
    ----------
    cause : str
        What became of it.
    complaint : str
        The last line that it printed: of readers of foreign bytes that is not to be shown.
    """

    def __init__(self, cause: str, complaint: str = "") -> None:
        self.cause = cause
        super().__init__(f"{cause}. {complaint}".rstrip(" ."))


class ChildOutOfMemory(ChildFailed):
    """A child could not allocate what it needed."""


def ask_child(
    request: dict[str, Any],
    seconds: float,
    command: Sequence[str],
    folder: Path | None = None,
    limits: Limits | None = None,
) -> dict[str, Any]:
    """Run a child on one request and return its answer.

    Raises `ChildOutOfMemory`, `ChildFailed`: also if the answer is an ``error``: its text.

    Parameters
    ----------
    request : dict
        Plain JSON; ``seconds`` is added.
    seconds : float
        Time limit; the child is killed after it.
    command : sequence of str
        Program and arguments. It finds Python modules where this process does.
    folder : Path, optional
        Where it works; default: where this process does.
    limits : Limits, optional
        Those of a child that confines itself and writes into `folder` alone: it is ended beyond them.
    """
    end = time.monotonic() + seconds
    answer = _ask(json.dumps(request | {"seconds": seconds}), _Watch(seconds, end, folder, limits), command)
    if "error" in answer:
        _refuse_no_memory(answer["error"])
        raise ChildFailed(answer["error"])
    return answer


@dataclass(frozen=True)
class _Watch:
    """How long a child may take, until which instant, where it works and what it may write there."""

    seconds: float
    end: float
    folder: Path | None
    limits: Limits | None

    def check(self, child: int) -> None:
        """Raise `ChildFailed` if a child takes more."""
        if time.monotonic() >= self.end:
            raise ChildFailed(f"no answer within {self.seconds:g} s")
        if self.folder is not None and self.limits is not None:
            cause = excess(child, self.folder, self.limits)
            if cause:
                raise ChildFailed(cause)

    @property
    def pause(self) -> float:
        """Time until the next look, s."""
        left = max(self.end - time.monotonic(), 0.0)
        return left if self.limits is None else min(left, LOOK_S)


def _ask(request: str, watch: _Watch, command: Sequence[str]) -> dict[str, Any]:
    # The child may find a module only where this process does, e.g. in a path added at run time.
    environment = child_environment(PYTHONPATH=os.pathsep.join(filter(None, sys.path)))
    pipes: Any = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE) | {"text": True}
    try:
        child = subprocess.Popen(command, env=environment, cwd=watch.folder, **pipes)
    except OSError as error:
        raise ChildFailed("cannot be started", error.strerror or "") from error
    with child:
        try:
            output, complaint = _communicated(child, request, watch)
        except BaseException:
            child.kill()
            raise
    _refuse_no_memory(_last_line(complaint) if child.returncode else "")
    if child.returncode != 0:
        signal = ending_signal(child.returncode)
        cause = f"killed by {signal}" if signal else f"ended with exit code {child.returncode}"
        raise ChildFailed(cause, _last_line(complaint))
    try:
        answer = json.loads(output)
    except json.JSONDecodeError as error:
        raise ChildFailed("unusable answer") from error
    return answer if isinstance(answer, dict) else {}


def _communicated(child: subprocess.Popen[str], request: str, watch: _Watch) -> tuple[str, str]:
    """Return what a child prints on both its outputs, once it has ended."""
    unsent: str | None = request
    while True:
        try:
            return child.communicate(unsent, timeout=watch.pause)
        except subprocess.TimeoutExpired:
            unsent = None  # the rest of it is sent by the next call
            watch.check(child.pid)


def _refuse_no_memory(complaint: str) -> None:
    """Raise what a child's complaint says, if that is a lack of memory."""
    if any(sign in complaint for sign in _NO_MEMORY):
        raise ChildOutOfMemory("ran out of memory")


def _last_line(text: str) -> str:
    lines = text.strip().splitlines()
    return lines[-1] if lines else ""
