"""Time and memory of the reduction of a cast box with four bored bosses, measured and predicted."""

from __future__ import annotations

from typing import Any

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

_BOX = """
import sys, gmsh
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
outer, inner = occ.addBox(0, 0, 0, 360, 240, 180), occ.addBox(10, 10, 10, 340, 220, 160)
box, _ = occ.cut([(3, outer)], [(3, inner)])
ends = [(x, y, toward) for x in (110, 250) for y, toward in ((0, 1), (240, -1))]
bosses = [(3, occ.addCylinder(x, y, 90, 0, 25 * toward, 0, 45)) for x, y, toward in ends]
bores = [(3, occ.addCylinder(x, y - 5 * toward, 90, 0, 35 * toward, 0, 31)) for x, y, toward in ends]
box, _ = occ.fuse(box, bosses)
box, _ = occ.cut(box, bores)
occ.fuse(box, [(3, occ.addBox(x, y, -15, 50, 40, 15)) for x in (0, 310) for y in (0, 200)])
occ.synchronize()
gmsh.write(sys.argv[1])
"""
_CODE = """
import resource, subprocess, sys, tempfile, time
from pathlib import Path
from dynamics.housings import (
    GRAY_CAST_IRON, Bore, Foot, MeshedHousing, Plane, SeatBore, mesh_step, reduced_housing,
)

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "box.step"
    subprocess.run([sys.executable, "-c", {box!r}, str(file)], check=True, capture_output=True)
    mesh = mesh_step(file, {size!r})
centers = [(x, y, 0.09) for x in (0.11, 0.25) for y in (0.0125, 0.2275)]
seats = tuple(SeatBore(str(k), Bore(at, (0.0, 1.0, 0.0), 0.062, 0.025)) for k, at in enumerate(centers))
feet = (Foot("base", Plane((0.0, 0.0, -0.015), (0.0, 0.0, -1.0))),)
start = time.process_time()
reduced = reduced_housing(MeshedHousing(mesh, GRAY_CAST_IRON, seats, feet, modes=80))
measured = {{
    "seconds": time.process_time() - start,
    "bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
    "freedoms": mesh.freedoms, "mass": reduced.body.mass,
    "first": reduced.frequency[0], "last": reduced.frequency[-1],
    "predicted_seconds": reduced.cost.predicted_seconds, "predicted_bytes": reduced.cost.predicted_bytes,
}}
"""
_TARGETS = {0.0139: (30.0, 1.5e9), 0.0088: (80.0, 3.2e9)}
"""CPU seconds and bytes by element size, m."""


def figures() -> list[Figure]:
    """Return time, memory and their predictions for each size."""
    return [figure for size in _TARGETS for figure in _reduction(size)]


def _reduction(size: float) -> list[Figure]:
    """Reduce the box at one element size."""
    run: dict[str, Any] = measure(_CODE.format(box=_BOX, size=size))
    seconds, memory = _TARGETS[size]
    subject = f"cast box, {run['mass']:.1f} kg, {run['freedoms']} freedoms, 80 modes, 4 seats"
    return [
        Figure(subject, "reduction", run["seconds"], "CPU s", seconds),
        Figure(subject, "peak memory", run["bytes"] / 1e9, "GB", memory / 1e9),
        Figure(subject, "predicted time", run["predicted_seconds"], "CPU s"),
        Figure(subject, "predicted memory", run["predicted_bytes"] / 1e9, "GB"),
        Figure(subject, "first mode", run["first"], "Hz"),
        Figure(subject, "highest mode kept", run["last"], "Hz"),
    ]
