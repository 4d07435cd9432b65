"""Cost and errors of the 5 s run-up of the example scene, bearing forces stored, on a table from a file."""

from __future__ import annotations

import tempfile
from pathlib import Path
from statistics import median

from benchmarks.example_pair import PAIR, TORQUES
from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

SCENE = Path(__file__).parents[1] / "examples" / "palermo_scene.toml"
_REPEATS = 3
TABLE = (
    PAIR
    + """
analyze(pair, torques={torques}, model="plane_strain").to_netcdf({table!r})
measured = {{}}
"""
)
_RUN = """
import time
from pathlib import Path
from dynamics.simulation import simulate
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.subjects import scene_of
from lineofaction.gearbox.convert.scene import dynamic_scene
given, _ = scene_of(Path({scene!r}))
scene = dynamic_scene(given, {{mesh.name: SteDatabase.from_netcdf({table!r}) for mesh in given.meshes}})
simulate(scene)
started = time.process_time()
simulate(scene)  # makes the code of the structure, if there is none yet
begun = time.process_time()
run = simulate(scene)
again = time.process_time() - begun
measured = {{"started": started, "again": again}}
"""
_ERRORS = (
    _RUN
    + """
from dataclasses import replace
checked = simulate(replace(scene, integration=replace(scene.integration, estimate_error=True)))
error = checked.receipt["error"]["time_step"]["rms"]
force = abs(float(run.mesh_force[0].mean()) / float(run.nominal_force[0]) - 1.0)
measured |= {{"error": error, "energy": run.energy.relative, "force": force}}
"""
)


def figures() -> list[Figure]:
    """Return the median times of several fresh processes, and the errors of one run."""
    with tempfile.TemporaryDirectory() as folder:
        names = {"scene": str(SCENE), "table": str(Path(folder) / "ste.nc")}
        measure(TABLE.format(torques=list(TORQUES), **names))
        errors = measure(_ERRORS.format(**names))  # compiles where nothing is cached yet
        runs = [measure(_RUN.format(**names)) for _ in range(_REPEATS)]
    again = median(run["again"] for run in runs)
    start_up = median(run["started"] for run in runs) - again
    subject = "5 s run-up, bearing forces stored"
    return [
        Figure(subject, "run-up, once compiled", again, "CPU s", 1.0),
        Figure(subject, "start-up of a compiled process", start_up, "CPU s", 3.0),
        Figure(subject, "step error of DTE, rms", 1e9 * errors["error"], "nm", 1.0),
        Figure(subject, "energy unaccounted for", 100.0 * errors["energy"], "%", 0.1),
        Figure(subject, "mean mesh force off nominal", 100.0 * errors["force"], "%"),
    ]
