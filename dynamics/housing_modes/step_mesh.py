"""Meshes of a STEP file, by gmsh in a child process."""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from dynamics.checks import one_of, positive
from dynamics.errors import InputError, SolveError
from dynamics.housing_modes.mesh_file import read_mesh
from dynamics.housing_modes.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import STEP_SUFFIXES
from host import ChildFailed, ChildOutOfMemory, ask_child

WORKER = Path(__file__).with_name("step_worker.py")
SECONDS = 600.0
WALL_ELEMENTS = 0.7
"""Elements over the mean wall thickness, 2 V/S of the body, unless a size is given: quadratic ones bend."""


def mesh_step(
    path: str | Path,
    element_size: float | None = None,
    seconds: float = SECONDS,
    command: Sequence[str] | None = None,
) -> TetrahedralMesh:
    """Mesh a STEP file with one solid by quadratic tetrahedra, whose nodes are on its curved surface.

    Parameters
    ----------
    path : str or Path
        ``.step`` or ``.stp``; its unit is read from it.
    element_size : float, optional
        Edge in m. Default: the mean wall thickness 2 V/S over 0.7. Curved faces get 12 elements a turn.
    seconds : float
        Time limit of the mesher.
    command : sequence of str, optional
        Program to run in place of the mesher.

    Raises
    ------
    InputError
        No such file, no solid or several, or a mesh that is bad at this size.
    SolveError
        The mesher failed, ran out of time or memory.
    """
    file = Path(path)
    one_of("step_file.suffix", file.suffix.lower(), STEP_SUFFIXES)
    if not file.is_file():
        raise InputError("step_file", file.name, "a file that exists")
    if element_size is not None:
        positive("element_size", element_size)
    with tempfile.TemporaryDirectory() as folder:
        copy = shutil.copyfile(file, Path(folder) / f"housing{file.suffix.lower()}")
        mesh = copy.with_suffix(".msh")
        request = {"step": copy.name, "mesh": mesh.name, "size": element_size}
        try:
            answer = ask_child(
                request | {"wall_elements": WALL_ELEMENTS},
                seconds,
                command or (sys.executable, "-P", str(WORKER)),
                copy.parent,
            )
        except ChildOutOfMemory as error:
            raise SolveError(f"mesher: {error}. Use a larger element_size.") from error
        except ChildFailed as error:
            raise SolveError(
                f"mesher: {error.cause}. Heal the geometry, or try another element_size."
            ) from error
        if answer.get("solids") != 1:
            advice = "Unite the solids in the CAD program."
            raise InputError("step_file.solids", answer.get("solids"), "one solid", advice)
        return read_mesh(mesh, "mm")
