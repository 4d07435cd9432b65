"""The child process that gmsh lives in: one request, one answer, its failures as `MeshError`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from fe_contact.errors import MeshError
from fe_contact.types import Json
from host import ChildFailed, ChildOutOfMemory, ask_child

WORKER = Path(__file__).with_name("gmsh_worker.py")
COMMAND = (sys.executable, "-S", "-P", str(WORKER))
"""Command of the worker, without `site`: it gets the paths of this process, and reads none of their files."""


def ask_gmsh(request: Json, seconds: float, command: Sequence[str] | None = None) -> Json:
    """Run the child on one request and return its answer.

    Raises `MeshError`: the child failed, was killed, ran out of time or answered nonsense; the message says
    which.

    Parameters
    ----------
    request : dict
        Plain JSON, see `gmsh_worker`.
    seconds : float
        Time limit; the child is killed after it.
    command : sequence of str, optional
        Program to run in place of the gmsh worker.
    """
    try:
        return ask_child(request, seconds, command or COMMAND)
    except ChildOutOfMemory as error:
        remedy = "Select a coarser level, or raise the memory limit."
        raise MeshError(f"gmsh worker: {error}. {remedy}") from error
    except ChildFailed as error:
        raise MeshError(f"gmsh worker: {error}") from error
