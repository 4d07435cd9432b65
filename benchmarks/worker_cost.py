"""Cost of jobs for a service: CPU time and memory of workers by process, bytes of results, requests, jobs."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks.boxed_scene import boxed_scene
from benchmarks.figures import Figure
from benchmarks.service_process import cpu_seconds, running
from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.subjects import case_of, scene_inputs

_EXAMPLES = Path(__file__).parents[1] / "examples"
_SUBJECT = "workers of the service"
_REQUESTS, _JOBS = 200, 1000
_SPEEDS = [300.0 + 60.0 * n for n in range(20)]
_MACHINE = {
    "force_wave_table": "temporal_order,spatial_order,speed_rpm,torque_n_m,radial_pressure_kpa,"
    "radial_phase_deg,tangential_pressure_kpa,tangential_phase_deg\n48,0,300,10,5,0,2,90\n",
    "bore_radius_mm": 65.0,
    "active_length_mm": 120.0,
    "speed_rpm": 300.0,
    "torque_n_m": 10.0,
}
_WRITERS = """
import sys
from pathlib import Path
from service.queue.submissions import Submissions
from service.store.database import open_database
file, inputs = Path(sys.argv[1]), {inputs!r}
engine = open_database(file)
submissions = Submissions(engine, 1)
for number in range({jobs}):
    key = format(number, "064x")
    submissions.submit("analyze", key, inputs, stored=True)
engine.dispose()
"""


def figures() -> list[Figure]:
    """Run one job of every process on a fresh directory, then ask for what is there."""
    with tempfile.TemporaryDirectory() as folder:
        directory, log = Path(folder), Path(folder) / "log.jsonl"
        with (
            running(directory / "data", log) as (address, process, _),
            LineOfActionClient(address, cache_dir=directory / "cache") as client,
        ):
            made = [*_jobs(client, log)]
            asked = [*_request_figures(client, process.pid)]
        return [*made, *asked, _growth(directory / "table.sqlite3")]


def orders() -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield what is run: a title, the process and its inputs; those of `listen` lack the hash of its run."""
    spur = case_of(_EXAMPLES / "palermo_spur_20_20.toml").model_dump(mode="json")
    helical = case_of(_EXAMPLES / "wind_turbine_high_speed.toml").model_dump(mode="json")
    relieved = json.loads(json.dumps(helical))
    relieved["pair"]["pinion"] |= {"tip_relief_um": 20.0, "tip_relief_length_mm": 1.5}
    scene = scene_inputs(_EXAMPLES / "palermo_scene.toml")
    study = tomllib.loads((_EXAMPLES / "optimize_tip_relief.toml").read_text("utf-8"))
    yield "analyze, spur, in the plane", "analyze", {"case": spur}
    yield "analyze, helical, three dimensions", "analyze", {"case": helical}
    yield "analyze, the same gears with a tip relief", "analyze", {"case": relieved}
    yield "flank, the same", "flank", {"case": relieved}
    yield "root stress, spur", "root-stress", {"case": spur}
    yield (
        "sensitivity, the same, 2 x 2 deviations",
        "sensitivity",
        {
            "case": relieved,
            "misalignment_um": [0.0, 20.0],
            "center_distance_change_percent": [0.0, 0.1],
        },
    )
    yield "optimize, spur, 800 evaluations", "optimize", {"case": spur, **study}
    yield "scatter, spur, 1000 pairs", "scatter", {"case": spur}
    yield "sweep, spur, torque", "sweep", {"case": spur, "over": ["torque"]}
    rungs = {"rungs": ["thin_slices", "corrected", "3d_draft"]}
    yield "frontier, spur, 3 rungs", "frontier", {"case": spur, **rungs}
    yield "ablate, spur, all effects", "ablate", {"case": spur}
    ring = case_of(_EXAMPLES / "internal_gear.toml").model_dump(mode="json")
    lugs = {"lugs": 8, "lug_radial_n_per_m": 2e8, "lug_tangential_n_per_m": 2e8}
    yield "elastic ring on 8 lugs", "elastic-ring", {"case": ring, **lugs}
    yield "simulate, rigid shafts, 5 s", "simulate", scene
    yield "modes", "modes", scene
    yield "deflect, the scene's own loads", "deflect", scene
    yield "response, 20 speeds", "response", scene | {"speed_rpm": _SPEEDS}
    yield "force waves, one order", "force-waves", scene | _MACHINE
    yield "complaint of 280 Hz", "complaint", scene | {"frequency_hz": 280.0, "speed_rpm": 840.0}
    after = json.loads(json.dumps(spur))
    after["pair"]["pinion"] |= {"tip_relief_um": 20.0, "tip_relief_length_mm": 1.5}
    brought = {"after": after, "tolerances": {"samples": 8}}
    yield "change, 8 pairs, 20 speeds", "change", scene | brought | {"speed_rpm": _SPEEDS}
    yield "steady, 20 speeds", "steady", scene | {"speed_rpm": _SPEEDS}
    boxed = boxed_scene(scene) | {"speed_rpm": _SPEEDS, "orders": 3}
    yield "vibration of a cast box, 20 speeds", "vibration", boxed
    yield "noise of the same, no bands", "noise", boxed | {"band": False}
    place = {"microphone_mm": [40.0, 60.0, 1000.0]}
    yield "listen, a run of 5 s at a microphone of it", "listen", boxed_scene(scene) | place
    speeds = {"path": "drives.motor.speed_rpm", "levels": _SPEEDS}
    varied = {"factors": [speeds], "responses": [{"quantity": "dte_rms"}]}
    yield "study, 20 speeds", "study", scene | varied


def _jobs(client: LineOfActionClient, log: Path) -> Iterator[Figure]:
    """Run one after the other; the log tells what each worker took."""
    run = ""
    for title, process, inputs in orders():
        result = client.obtain(process, inputs | {"run": run} if process == "listen" else inputs)
        if process == "simulate":
            run = result.key
        ended = [json.loads(line) for line in log.read_text("utf-8").splitlines() if "worker ended" in line]
        took = ended[-1]
        if (took["process"], took["outcome"]) != (process, "done"):
            raise RuntimeError(f"{title}: {took}")
        yield Figure(_SUBJECT, f"{title}: CPU time", took["cpu_s"], "CPU s")
        yield Figure(_SUBJECT, f"{title}: most memory", took["peak_mb"], "MB")
        size = client.fetch_file(result.key, result.kind).stat().st_size
        yield Figure(_SUBJECT, f"{title}: result", size / 1e6, "MB")


def _request_figures(client: LineOfActionClient, pid: int) -> Iterator[Figure]:
    """CPU time of the service for what callers do most."""
    case = {"case": case_of(_EXAMPLES / "palermo_spur_20_20.toml").model_dump(mode="json")}
    job = client.submit("analyze", case)
    for title, ask in (
        ("status of a job", lambda: client.status(job.id)),
        ("submission of a case that is known", lambda: client.submit("analyze", case)),
    ):
        before = cpu_seconds(pid)
        for _ in range(_REQUESTS):
            ask()
        cpu_per_request = (cpu_seconds(pid) - before) / _REQUESTS
        yield Figure(
            "requests to the service", f"{title}: CPU time of the service", 1e3 * cpu_per_request, "ms"
        )


def _growth(file: Path) -> Figure:
    """Bytes of the job table for each case and its job, on SQLite."""
    inputs = {"case": case_of(_EXAMPLES / "palermo_spur_20_20.toml").model_dump(mode="json")}
    code = _WRITERS.format(inputs=inputs, jobs=_JOBS)
    subprocess.run([sys.executable, "-c", code, str(file)], check=True)
    return Figure("job table", f"for one of {_JOBS} cases and jobs", file.stat().st_size / _JOBS / 1e3, "kB")
