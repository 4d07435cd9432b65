"""Cost of the runs of a study beyond their integration: the example scene with other bearings and speeds."""

from __future__ import annotations

import tempfile
from pathlib import Path
from statistics import median

from benchmarks.example_pair import TORQUES
from benchmarks.figures import Figure
from benchmarks.fresh_process import measure
from benchmarks.run_up import SCENE, TABLE

TARGET = 8.0
"""Largest cost of a run beyond its integration, ms of CPU time."""
_REPEATS = 3
_STUDY = """
import time
from pathlib import Path
from dynamics.study import Design, Levels, Normal, Response, StudyTask, Uniform, study, with_effects
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.studies.study.scenes import VariedScene, places_of
from lineofaction.gearbox.subjects import scene_of
inputs, _ = scene_of(Path({scene!r}))
tables = {{mesh.name: SteDatabase.from_netcdf({table!r}) for mesh in inputs.meshes}}
factors = {{
    "run.duration_s": Levels((0.3,)),
    "drives.motor.speed_rpm": Levels((500.0, 900.0)),
    "meshes.mesh.damping_ratio": Uniform(0.05, 0.15),
    "bushings.*.radial_stiffness_n_per_m": Normal(1e8, 1e7, 7e7, 1.3e8),
}}
scenes = VariedScene(
    inputs.model_dump_json(), tables, {{path: places_of(inputs, path, path) for path in factors}}, {home!r}
)
responses = Response("bearing_force", "input left", order=1), Response("dte_peak_to_peak")
task = StudyTask(scenes, tuple(factors), responses, start=0.1)
study(task, Design(factors, 2))
began = time.process_time()
design = Design(factors, 30, seed=1)
made = study(with_effects(task, design), design)
decision = made.metadata["effects"]["cpu_seconds"]
taken = (time.process_time() - began - decision) / len(made.reason)
integration = float(made.seconds[:, 1].mean())
assert made.usable == len(made.reason)
measured = {{"run": taken, "beyond": taken - integration, "decision": decision}}
"""


def figures() -> list[Figure]:
    """Return the median times of several fresh processes."""
    with tempfile.TemporaryDirectory() as folder:
        files = {"scene": str(SCENE), "table": str(Path(folder) / "ste.nc"), "home": folder}
        measure(TABLE.format(torques=list(TORQUES), **files))
        measure(_STUDY.format(**files))  # compiles where nothing is cached yet
        times = [measure(_STUDY.format(**files)) for _ in range(_REPEATS)]
    subject = "study of 60 runs of 0.3 s, bearings, damping and speed varied"
    names = "run", "beyond", "decision"
    run, beyond, decision = (1e3 * median(each[name] for each in times) for name in names)
    return [
        Figure(subject, "a run", run, "CPU ms"),
        Figure(subject, "a run beyond its integration", beyond, "CPU ms", TARGET),
        Figure(subject, "decision on effects, once for all runs", decision, "CPU ms"),
    ]
