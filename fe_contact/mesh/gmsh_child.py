"""The child process that gmsh lives in: one request, one answer, its failures as `MeshError`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fe_contact.errors import MeshError
from fe_contact.types import Json
from host import ending_signal

_NO_MEMORY = ("MemoryError", "bad_alloc")
"""How Python and C++ say that an allocation failed."""
WORKER = Path(__file__).with_name("gmsh_worker.py")


def ask_gmsh(request: Json, seconds: float, command: Sequence[str] | None = None) -> Json:
    """Run the child on one request and return its answer.

    Parameters
    ----------
    request : dict
        Plain JSON, see `gmsh_worker`.
    seconds : float
        Time limit; the child is killed after it.
    command : sequence of str, optional
        Program to run in place of the gmsh worker.

    Raises
    ------
    MeshError
        The child failed, was killed, ran out of time or answered nonsense; the message says which.
    """
    request = request | {"seconds": seconds}
    answer = _ask(json.dumps(request), seconds, command or (sys.executable, "-P", str(WORKER)))
    if "error" in answer:
        _refuse_no_memory(answer["error"])
        raise MeshError(f"gmsh: {answer['error']}")
    return answer


def _ask(request: str, seconds: float, command: Sequence[str]) -> dict[str, Any]:
    """Run the child on one request and return its answer."""
    # The child may find gmsh only where this process does, e.g. in a path added at run time.
    environment = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    try:
        child = subprocess.run(
            command,
            input=request,
            capture_output=True,
            text=True,
            timeout=seconds,
            env=environment,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise MeshError(f"gmsh worker: no mesh within {seconds:g} s") from error
    except OSError as error:
        raise MeshError(f"gmsh worker: cannot be started ({error})") from error
    _refuse_no_memory(_last_line(child.stderr) if child.returncode else "")
    if child.returncode != 0:
        raise MeshError(f"gmsh worker: {_cause(child.returncode)}. {_last_line(child.stderr)}".rstrip(" ."))
    try:
        answer = json.loads(child.stdout)
    except json.JSONDecodeError as error:
        raise MeshError(f"gmsh worker: unusable answer ({error})") from error
    return answer if isinstance(answer, dict) else {}


def _refuse_no_memory(complaint: str) -> None:
    """Raise what a child's complaint says, if that is a lack of memory."""
    if any(sign in complaint for sign in _NO_MEMORY):
        raise MeshError("gmsh worker: ran out of memory. Select a coarser level, or raise the memory limit.")


def _cause(returncode: int) -> str:
    """Say how a child ended."""
    if returncode >= 0:
        return f"ended with exit code {returncode}"
    return f"killed by {ending_signal(returncode)}"


def _last_line(text: str) -> str:
    """Return the last line a child complained with."""
    lines = text.strip().splitlines()
    return lines[-1] if lines else ""
