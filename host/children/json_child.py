"""A child process that gets one JSON object on standard input and answers with one on standard output."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from host.children.environment import child_environment
from host.children.watch import Watch
from host.reading_limits import Limits
from host.sessions import ending_signal

HOUSES = Path(__file__).parents[2]
"""Folder of the houses: of an editable installation it is in no path, but found by a hook."""
_NO_MEMORY = ("MemoryError", "bad_alloc")
"""Texts by which Python and C++ report that an allocation failed."""


class ChildFailed(Exception):
    """A child failed, was killed, ran out of time or answered nonsense; the message says which.

    Parameters
    ----------
    cause : str
        Reason of the failure, e.g. "killed by SIGKILL".
    complaint : str
        The last line that it printed, which may quote its input. Do not show it to users where the child
        reads files of others: `cause` alone is safe.
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

    Raises `ChildOutOfMemory`; `ChildFailed`, also with the text of an ``error`` in the answer.

    Parameters
    ----------
    request : dict
        Plain JSON; ``seconds`` is added.
    seconds : float
        Time limit; the child is killed after it.
    command : sequence of str
        Program and arguments. It finds Python modules where this process does.
    folder : Path, optional
        Working directory of the child; default: that of this process.
    limits : Limits, optional
        Limits of what the child writes into `folder`; the child is killed when it exceeds them. The child
        must confine itself to writing there alone.
    """
    watch = Watch.begun(seconds, folder, limits)
    answer = _ask(json.dumps(request | {"seconds": seconds}), watch, command)
    if "error" in answer:
        _refuse_no_memory(answer["error"])
        raise ChildFailed(answer["error"])
    return answer


def _ask(request: str, watch: Watch, command: Sequence[str]) -> dict[str, Any]:
    # The child may find a module only where this process does, e.g. in a path added at run time.
    paths = [*filter(None, sys.path), str(HOUSES)]
    environment = child_environment(PYTHONPATH=os.pathsep.join(paths))
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
    return answer if isinstance(answer, dict) else {}  # callers take it for an answer without keys


def _communicated(child: subprocess.Popen[str], request: str, watch: Watch) -> tuple[str, str]:
    """Return both outputs of a child, once it has ended."""
    unsent: str | None = request
    while True:
        try:
            return child.communicate(unsent, timeout=watch.pause)
        except subprocess.TimeoutExpired:
            unsent = None  # the rest of it is sent by the next call
            if watch.late:
                raise ChildFailed(f"no answer within {watch.seconds:g} s") from None
            if excess := watch.excess(child.pid):
                raise ChildFailed(excess) from None


def _refuse_no_memory(complaint: str) -> None:
    """Raise `ChildOutOfMemory` if a child's complaint is a lack of memory."""
    if any(sign in complaint for sign in _NO_MEMORY):
        raise ChildOutOfMemory("ran out of memory")


def _last_line(text: str) -> str:
    lines = text.strip().splitlines()
    return lines[-1] if lines else ""
