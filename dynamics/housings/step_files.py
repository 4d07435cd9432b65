"""STEP files of housings by gmsh in a child process: their mesh, and the faces of their solid."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

import numpy as np

from dynamics.checks import one_of, positive
from dynamics.errors import InputError, SolveError
from dynamics.housings.mesh_faces import Bore, Plane
from dynamics.housings.mesh_files import read_mesh
from dynamics.housings.step_bores import BoreWall, bores_of_walls
from dynamics.housings.step_worker import ELEMENTS_A_TURN, limits
from dynamics.housings.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import STEP_SUFFIXES
from host import ChildFailed, ChildOutOfMemory, ask_child

STEP_WORKER = Path(__file__).with_name("step_worker.py")
STEP_SECONDS = 600.0  # usual limit of the time that gmsh takes for a STEP file, s
WALL_ELEMENTS = 0.7
"""Elements over the mean wall thickness 2 V/S of the body, unless a size is given.

Fewer than one suffices for the bending of a wall, since the elements are quadratic.
"""
Made = TypeVar("Made")


def mesh_step(
    path: str | Path,
    element_size: float | None = None,
    seconds: float = STEP_SECONDS,
    command: Sequence[str] | None = None,
) -> TetrahedralMesh:
    """Mesh a STEP file with one solid by quadratic tetrahedra, whose nodes are on its curved surface.

    Raises `InputError`: no such file, no solid or several, or a mesh that is bad at this size; `SolveError`:
    the mesher failed, ran out of time or memory.

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
    """
    if element_size is not None:
        positive("element_size", element_size)
    request = {"mesh": "housing.msh", "size": element_size, "wall_elements": WALL_ELEMENTS}

    def mesh(_: dict[str, Any], folder: Path) -> TetrahedralMesh:
        return read_mesh(folder / "housing.msh", "mm")

    return _by_gmsh(Path(path), request, mesh, seconds, command)


def usual_edge(wall: float, diameter: float) -> float:
    """Return the edge of elements at the wall of a bore without a size, m.

    `wall`: mean wall thickness 2 V/S of the body, m.
    """
    return min(wall / WALL_ELEMENTS, np.pi * diameter / ELEMENTS_A_TURN)


@dataclass(frozen=True)
class FlatFace:
    """A flat part of the surface of a solid; its area in m^2."""

    plane: Plane
    area: float


@dataclass(frozen=True)
class StepSolid:
    """Volume, surface, bores and planes of the one solid of a STEP file, in the frame of the file."""

    volume: float
    surface: float
    """`volume`, `surface`: Volume, m^3, and surface area, m^2."""
    bores: tuple[Bore, ...]
    """Round holes of which at least half of the wall is there; the halves of a split bore are one bore."""
    planes: tuple[FlatFace, ...]
    """Flat faces, the largest first."""


def step_solid(path: str | Path, seconds: float = STEP_SECONDS) -> StepSolid:
    """Return the bores and planes of the one solid in a STEP file, which is not meshed.

    Raises `InputError`: no such file, no solid or several; `SolveError`: the reader failed, ran out of time
    or memory.
    """

    def solid(answer: dict[str, Any], _: Path) -> StepSolid:
        planes = [
            FlatFace(Plane(tuple(point), tuple(normal)), area) for point, normal, area in answer["planes"]
        ]
        planes.sort(key=lambda face: -face.area)
        # `rest`: radius, area, low and high end
        walls = [BoreWall(np.array(point), np.array(axis), *rest) for point, axis, *rest in answer["walls"]]
        return StepSolid(answer["volume"], answer["surface"], tuple(bores_of_walls(walls)), tuple(planes))

    return _by_gmsh(Path(path), {"mesh": None}, solid, seconds)


def _by_gmsh(
    file: Path,
    request: dict[str, Any],
    made: Callable[[dict[str, Any], Path], Made],
    seconds: float,
    command: Sequence[str] | None = None,
) -> Made:
    """Return the result of `made` with the answer of the child, which works on a copy of the file."""
    one_of("step_file.suffix", file.suffix.lower(), STEP_SUFFIXES)
    if not file.is_file():
        raise InputError("step_file", file.name, "a file that exists")
    with TemporaryDirectory() as folder:
        copy = shutil.copyfile(file, Path(folder) / f"housing{file.suffix.lower()}")
        run = command or (sys.executable, "-P", str(STEP_WORKER))  # -P: no import from the worker's folder
        try:
            maximum = limits(seconds)
            answer = ask_child(request | {"step": copy.name}, seconds, run, copy.parent, maximum)
        except ChildOutOfMemory as error:
            raise SolveError(f"mesher: {error}. Use a larger element_size.") from error
        except ChildFailed as error:
            raise SolveError(
                f"mesher: {error.cause}. Heal the geometry, or try another element_size."
            ) from error
        if answer.get("solids") != 1:
            remedy = "Unite the solids in the CAD program."
            raise InputError("step_file.solids", answer.get("solids"), "one solid", remedy)
        return made(answer, copy.parent)
