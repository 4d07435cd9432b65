"""A two-stage unit from its REXS file to its sound: in a case, deflected, optimized, heard, run up.

    python examples/two_stage/unit.py -o unit            # writes unit/*, prints tables
    python examples/two_stage/unit.py -o unit --quick    # coarse case, few designs, one load case, no runs

Every step is a verb of `loa`; the files between them are those that a user of the command line would have.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from gear_case import housing_of, seats_of
from pictures import write_pictures
from sound import levels, write_sounds

from dynamics.noise import RadiatedSound
from dynamics.orders import order_track
from dynamics.results import RunResult
from service.convert.toml import toml_text

UNIT = Path(__file__).parent
ORDERS = 3
"""Multiples of each mesh frequency that are compared."""
ORDER_OF = {"first stage": 1.0, "second stage": 21.0 / 63.0}
"""Mesh frequencies over that of the first stage: teeth of pinion 2 over those of wheel 1."""
SPEEDS = 500.0, 6000.0
"""Of the run-up, rpm of the input."""


@dataclass(frozen=True)
class Effort:
    """What the steps spend.

    Attributes
    ----------
    evaluations : int
        Most designs of the search.
    duration : float
        Of the run-up, s; 0: none.
    load_cases : int
        Of the spectrum, the largest shares of time first.
    element_size_mm : float
        Of the mesh of the case.
    modes : int
        Of the case that are kept.
    speed_rpm : str
        Speeds at which the sound is found.
    orders : int
        Multiples of the first mesh's frequency in it.
    """

    evaluations: int
    duration: float
    load_cases: int
    element_size_mm: float
    modes: int
    speed_rpm: str
    orders: int


ACCURACY = {"level": "draft"}
"""Of the cases: REXS states none."""
THOROUGH = Effort(120, 1.0, 4, 20.0, 80, "500:6000:25", 3)
QUICK = Effort(8, 0.0, 1, 40.0, 40, "500:6000:50", 1)
HEARD = 5.0
"""Duration of the run-ups to listen to, s."""


def loa(*arguments: object) -> str:
    """Run a verb and return what it prints; its complaints end the script."""
    program = Path(sys.executable).with_name("loa")
    done = subprocess.run([program, *map(str, arguments)], stdout=subprocess.PIPE, text=True, check=True)
    return done.stdout


def amend(case: Path, **tables: Any) -> None:
    """Give a case file other tables of these names."""
    content = tomllib.loads(case.read_text("utf-8")) | tables
    case.write_text(toml_text(content), encoding="utf-8")


def opened(folder: Path, effort: Effort) -> Path:
    """Open the REXS file and return the scene; every case gets its accuracy, the scene its gear case."""
    loa("open", UNIT / "two_stage.rexs", "--out", folder)
    for case in folder.glob("*_stage.toml"):
        amend(case, accuracy=ACCURACY)
    loads = tomllib.loads((folder / "load_cases.toml").read_text("utf-8"))["load_cases"]
    longest = sorted(loads, key=lambda load: -load["share"])[: effort.load_cases]
    amend(folder / "load_cases.toml", load_cases=[load for load in loads if load in longest])
    housed(folder / "scene.toml", effort)
    return folder / "scene.toml"


def housed(scene: Path, effort: Effort) -> None:
    """Write the gear case and put it in place of the stiffness that the REXS file states."""
    step = scene.with_name("gear_case.step")
    subprocess.run(
        [sys.executable, UNIT / "gear_case.py", scene, step], stdout=subprocess.DEVNULL, check=True
    )
    seats = seats_of(tomllib.loads(scene.read_text("utf-8")))
    settings = {"modes": effort.modes, "element_size_mm": effort.element_size_mm}
    amend(scene, housings=[housing_of(seats, step.name, **settings)])


def deflected(scene: Path, output: Path) -> dict[str, Any]:
    """Deflect the unit over its load spectrum and return the figures."""
    facts = json.loads(loa("deflect", scene, scene.with_name("load_cases.toml"), "-o", output, "--json"))
    return dict(facts)


def file_of(stage: str) -> str:
    """Return the name of a stage's case file."""
    return f"{stage.replace(' ', '_')}.toml"


def optimized(stage: str, output: Path, effort: Effort) -> Path:
    """Optimize a stage over the spectrum that its deflection wrote and return its best case."""
    case = output / f"deflection_{file_of(stage)}"
    study = output / "study.toml"
    spectrum = case.with_name(f"{case.stem}_optimize.toml").read_text("utf-8")
    flanks = (UNIT / "flanks.toml").read_text("utf-8")
    study.write_text(f"{spectrum}\n{flanks}\n[search]\nevaluations = {effort.evaluations}\n", "utf-8")
    loa("optimize", case, study, "-o", output / "best.toml")
    return output / "best.toml"


def aligned(scene: Path, facts: dict[str, Any]) -> None:
    """Set both stages to the mean misalignment that the deflection found."""
    meshes = tomllib.loads(scene.read_text("utf-8"))["meshes"]
    for mesh, found in zip(meshes, facts["meshes"], strict=True):
        mesh["misalignment_um"] = round(found["mean_misalignment_um"], 3)
        amend(scene.with_name(mesh["case_file"]), errors={"misalignment_um": [mesh["misalignment_um"]]})
    amend(scene, meshes=meshes)


def run_up(scene: Path, duration: float) -> Path:
    """Run the input from 500 to 6000 rpm at the torque of the scene and return the run."""
    settings = {
        "run.duration_s": duration,
        "drives.motor.time_s": [0.0, duration],
        "drives.motor.speed_rpm": list(SPEEDS),
    }
    run = scene.with_name("run.nc")
    loa("simulate", scene, "-o", run, *(f"--set={name}={value}" for name, value in settings.items()))
    return run


def peak_levels(path: Path) -> dict[str, float]:
    """Return the highest amplitude of each mesh order, N: of all bearings, directions and speeds."""
    run = RunResult.from_netcdf(path)
    levels = {}
    for mesh, name in enumerate(run.mesh):
        track = order_track(run, "bearing_force", highest=ORDERS, mesh=mesh)
        for order in range(1, ORDERS + 1):
            levels[f"{name}, order {order}"] = float(np.max(track.amplitude[..., order]))
    return levels


def ripples(before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """Return the table of both stages' ripple over the spectrum."""
    rows = [f"{'':44}{'before':>10}{'after':>10}"]
    for old, new in zip(before["meshes"], after["meshes"], strict=True):
        pair = old["mean_peak_to_peak_um"], new["mean_peak_to_peak_um"]
        rows.append(f"{old['name'] + ', peak-to-peak STE, um':44}{pair[0]:10.3f}{pair[1]:10.3f}")
    return rows


def force_peaks(runs: tuple[Path, Path]) -> list[str]:
    """Return the rows of the peaks of bearing forces in two runs."""
    before, after = (peak_levels(run) for run in runs)
    return [f"{name + ', N':44}{before[name]:10.1f}{after[name]:10.1f}" for name in before]


def heard(scene: Path, effort: Effort) -> RadiatedSound:
    """Find the sound power of a scene over speed, with its map and page."""
    file = scene.with_name("sound.nc")
    loa("noise", scene, "--speed-rpm", effort.speed_rpm, "--orders", effort.orders, "-o", file)
    loa("report", file, "-o", file.with_suffix(".html"), "--images", file.with_name("sound"))
    return RadiatedSound.from_netcdf(file)


def main() -> None:
    """Open, deflect, optimize, deflect, run up, listen, compare."""
    parser = argparse.ArgumentParser(description="A two-stage unit over its load spectrum.")
    parser.add_argument("-o", "--output", type=Path, default=Path("two_stage"), help="folder to write")
    parser.add_argument("--quick", action="store_true", help="coarse case, few designs, no runs")
    options = parser.parse_args()
    effort, folder = QUICK if options.quick else THOROUGH, options.output

    scene = opened(folder / "before", effort)
    before = deflected(scene, folder / "deflected")
    worst = max(before["meshes"], key=lambda mesh: float(mesh["mean_peak_to_peak_um"]))["name"]
    best = optimized(worst, folder / "deflected", effort)
    better = shutil.copytree(folder / "before", folder / "after", dirs_exist_ok=True) / "scene.toml"
    shutil.copy(best, better.with_name(file_of(worst)))
    after = deflected(better, folder / "deflected_after")
    seconds = before["cpu_seconds"], after["cpu_seconds"]
    print(f"deflected in {seconds[0]:.1f} and {seconds[1]:.1f} CPU s; optimized: {worst}")
    print(*ripples(before, after), sep="\n")
    aligned(scene, before)
    aligned(better, after)
    sounds = {name: heard(folder / name / "scene.toml", effort) for name in ("before", "after")}
    print(*levels(sounds["before"], sounds["after"], ORDER_OF), sep="\n")
    write_sounds(folder, sounds, HEARD)
    write_pictures(folder, scene, sounds["before"], effort.orders)
    if effort.duration:
        runs = run_up(scene, effort.duration), run_up(better, effort.duration)
        print(*force_peaks(runs), sep="\n")
        for name, run in zip(("before", "after"), runs, strict=True):
            loa("report", run, "-o", folder / f"run_up_{name}.html")


if __name__ == "__main__":
    main()
