"""The example scene at constant speed, here and in Exudyn: agreement, and CPU time at equal step error.

Each engine gets the cheapest of its settings whose measured error is at most `ERROR`: here a tolerance,
there a fixed step. Times are those of the time integration alone on both sides, and of all that `simulate`
does. Left out where Exudyn is not installed.
"""

from __future__ import annotations

import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from benchmarks.example_pair import PAIR, TORQUES
from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

ERROR = 1e-9
SECONDS = 0.5
TARGET = 100.0 / 30.0
SUBJECT = "0.5 s at 900 rpm, here and in Exudyn"
SOLVERS = {"GeneralizedAlpha": "its implicit solver", "RK44": "its fastest solver, explicit"}
METHODS = ("implicit", "explicit")
_TABLE = (
    PAIR
    + """
analyze(pair, torques={torques}, model="plane_strain").to_netcdf({table!r})
measured = {{}}
"""
)
_RUNS = """
import time
from dataclasses import replace
from statistics import median
import numpy as np
from benchmarks.exudyn_pair import constant_speed_scene
from benchmarks.exudyn_scene import run_in_exudyn
from dynamics.integrators import integrate, static_equilibrium
from dynamics.simulation import simulate
from dynamics.assembly.assemble import assemble
from dynamics.scene import Integration
from fe_contact.ste import SteDatabase
scene = constant_speed_scene(SteDatabase.from_netcdf({table!r}), 900.0, {seconds})

system = assemble(scene)
start = static_equilibrium(system)

def own(tolerance, method="implicit"):
    chosen = Integration(method=method, tolerance=tolerance)
    began = time.process_time()
    integrate(system, start, chosen)
    alone = time.process_time() - began
    began = time.process_time()
    run = simulate(replace(scene, integration=chosen))
    return run.dynamic_transmission_error[0], alone, time.process_time() - began

def other(solver, parts):
    run = run_in_exudyn(scene, solver=solver, step=5e-5 / parts)
    return run.dynamic_transmission_error, run.cpu_seconds

def rms(values):
    return float(np.sqrt(np.mean(values**2)))

def cheapest(run, settings):
    for setting in settings:
        error = rms(run(setting)[0] - exact)
        if error <= {error}:
            times = [run(setting)[1:] for _ in range(5)]
            alone, *whole = (median(values) for values in zip(*times))
            return dict(error=error, setting=float(setting), seconds=alone, whole=whole)

exact = own(1e-12)[0]
tolerances = 8e-8 / 2.0 ** np.arange(0.0, 9.0, 0.5)
measured = {{method: cheapest(lambda t, m=method: own(t, m), tolerances) for method in {methods}}}
parts = (1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 64)
for solver in {solvers}:
    measured[solver] = cheapest(lambda n: other(solver, n), parts)
measured["difference"] = rms(other("RK44", 32)[0] - exact) / float(np.std(exact))
"""


def figures() -> list[Figure]:
    """Return agreement, CPU seconds at the error, and their ratios; nothing without Exudyn."""
    if find_spec("exudyn") is None:
        sys.stderr.write("  left out: Exudyn is not installed (pip install exudyn)\n")
        return []
    with tempfile.TemporaryDirectory() as folder:
        table = str(Path(folder) / "ste.nc")
        measure(_TABLE.format(torques=list(TORQUES), table=table))
        code = _RUNS.format(table=table, seconds=SECONDS, error=ERROR, solvers=list(SOLVERS), methods=METHODS)
        found = measure(code)
    swing = 100.0 * found["difference"]
    rows = [Figure(SUBJECT, "difference of the transmission errors, rms over swing", swing, "%", 1.0)]
    for method in METHODS:
        own = found[method]
        rows += [
            Figure(SUBJECT, f"here, {method}: time integration", own["seconds"], "CPU s"),
            Figure(SUBJECT, f"here, {method}: all of simulate", own["whole"][0], "CPU s"),
            Figure(SUBJECT, f"here, {method}: step error", 1e9 * own["error"], "nm", 1.0),
        ]
    best = min((found[method] for method in METHODS), key=lambda own: float(own["seconds"]))
    for solver, text in SOLVERS.items():
        other = found[solver]
        alone, whole = (100.0 * spent / other["seconds"] for spent in (best["seconds"], best["whole"][0]))
        rows += [
            Figure(SUBJECT, f"{text} ({solver}): time integration", other["seconds"], "CPU s"),
            Figure(SUBJECT, f"{solver}: step error", 1e9 * other["error"], "nm", 1.0),
            Figure(SUBJECT, f"time integration here over {solver}", alone, "%", TARGET),
            Figure(SUBJECT, f"all of simulate over {solver}'s time integration", whole, "%"),
        ]
    return rows
