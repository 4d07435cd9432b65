"""Child process that meshes a STEP file with gmsh, and does nothing else.

Run as a script by `dynamics.housings.mesh_files`, never imported by it: gmsh changes signal handlers, may
crash on hard input and keeps global state, so it lives and dies here, in a folder of its own, which is all
that it can reach (`host.confine`). It reads one JSON object from standard input and writes one to standard
output::

    {"step": "housing.step", "mesh": "housing.msh", "size": m or null, "wall_elements": 0.7, "seconds": 600}
    {"solids": 1, "size": 0.014}   or   {"error": "..."}
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any

from host import Limits, confine, end_after, handlers_kept

RESET_BY_GMSH = ("SIGTERM", "SIGHUP", "SIGPIPE", "SIGINT")
MILLIMETER = 1e-3
ELEMENTS_A_TURN = 12
FRONTAL_DELAUNAY = 6
WORST = 0.05
"""Quality of a tetrahedron (its inverse condition number, 1 if it is regular) below which a mesh is made
again: Delaunay's method leaves slivers in the walls of castings."""


def _start_gmsh() -> Any:
    """Import and start gmsh: one thread, silent, no user files, signal handlers left as they were."""
    import gmsh  # noqa: PLC0415

    with handlers_kept(RESET_BY_GMSH):
        gmsh.initialize(["loa", "-nopopup"], readConfigFiles=False, interruptible=False)
    options = {
        "General.Terminal": 0,
        "General.NumThreads": 1,
        "Geometry.OCCImportLabels": 0,  # with labels, other files that a STEP file names are read
        "Mesh.Algorithm": FRONTAL_DELAUNAY,
        "Mesh.ElementOrder": 2,
        "Mesh.HighOrderOptimize": 1,
        "Mesh.MeshSizeFromPoints": 0,
        "Mesh.MeshSizeFromCurvature": ELEMENTS_A_TURN,
        "Mesh.Optimize": 1,
    }
    for name, value in options.items():
        gmsh.option.setNumber(name, value)
    gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    return gmsh


def _mesh(gmsh: Any, request: dict[str, Any]) -> dict[str, Any]:
    """Mesh the one solid of a file, in mm."""
    try:
        gmsh.model.occ.importShapes(request["step"])
        gmsh.model.occ.synchronize()
    except Exception:  # noqa: BLE001 - its text may hold what is in the file
        return {"error": "gmsh does not read the file"}
    solids = gmsh.model.getEntities(3)
    if len(solids) != 1:
        return {"solids": len(solids)}
    size = request["size"] or MILLIMETER * _wall_thickness(gmsh, solids[0][1]) / request["wall_elements"]
    gmsh.option.setNumber("Mesh.MeshSizeMax", size / MILLIMETER)
    gmsh.model.addPhysicalGroup(3, [solids[0][1]])  # only its elements are written
    try:
        gmsh.model.mesh.generate(3)
        _, tags, _ = gmsh.model.mesh.getElements(3)
        if min(quality.min() for quality in map(gmsh.model.mesh.getElementQualities, tags)) < WORST:
            # twice the time, a sixth more elements: on demand
            gmsh.option.setNumber("Mesh.OptimizeNetgen", 1)
            gmsh.model.mesh.clear()
            gmsh.model.mesh.generate(3)
    except Exception as error:  # noqa: BLE001 - gmsh says what is wrong with the geometry
        return {"error": str(error)}
    gmsh.write(request["mesh"])
    return {"solids": 1, "size": size}


def _wall_thickness(gmsh: Any, solid: int) -> float:
    """Return 2 V/S of a solid, the mean thickness of a thin-walled one, mm."""
    volume = gmsh.model.occ.getMass(3, solid)
    faces = gmsh.model.getBoundary([(3, solid)], oriented=False)
    return float(2.0 * volume / sum(gmsh.model.occ.getMass(2, face) for _, face in faces))


def _main() -> None:
    """Answer the one request on standard input."""
    answer_to = os.dup(1)
    os.dup2(2, 1)  # whatever gmsh prints must not mix with the answer
    request = json.load(sys.stdin)
    end_after(int(request["seconds"]) + 1)  # ends this process even when its parent is gone
    confine(Path.cwd(), Limits(memory_mb=None, cpu_seconds=int(request["seconds"]) + 1))
    try:
        answer = _mesh(_start_gmsh(), request)
    except MemoryError:
        answer = {"error": "MemoryError"}
    except Exception:  # noqa: BLE001 - bare Exception is what gmsh raises; its text may hold what is in the file
        answer = {"error": "gmsh failed"}
    with os.fdopen(answer_to, "w") as stream:
        json.dump(answer, stream)


if __name__ == "__main__":
    _main()
