"""A two-stage unit from its REXS file: opened, deflected, its worse stage optimized, deflected again, run up.

    python examples/two_stage/unit.py -o unit            # writes unit/*.html, prints a table
    python examples/two_stage/unit.py -o unit --quick    # few designs, a short run: 6 CPU minutes

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

from dynamics.orders import order_track
from dynamics.results import RunResult
from service.convert.toml import toml_text

UNIT = Path(__file__).parent
ORDERS = 3
"""Multiples of each mesh frequency that are compared."""


@dataclass(frozen=True)
class Effort:
    """What the steps spend.

    Attributes
    ----------
    evaluations : int
        Most designs of the search.
    duration : float
        Of the run-up, s.
    """

    evaluations: int
    duration: float


ACCURACY = {"level": "draft"}
"""Of the cases: REXS states none."""
THOROUGH, QUICK = Effort(120, 1.0), Effort(12, 0.1)


def loa(*arguments: object) -> str:
    """Run a verb and return what it prints; its complaints end the script."""
    program = Path(sys.executable).with_name("loa")
    done = subprocess.run([program, *map(str, arguments)], stdout=subprocess.PIPE, text=True, check=True)
    return done.stdout


def amend(case: Path, **tables: Any) -> None:
    """Give a case file other tables of these names."""
    content = tomllib.loads(case.read_text("utf-8")) | tables
    case.write_text(toml_text(content), encoding="utf-8")


def opened(folder: Path) -> Path:
    """Open the REXS file and return the scene; every case gets its accuracy."""
    loa("open", UNIT / "two_stage.rexs", "--out", folder)
    for case in folder.glob("*_stage.toml"):
        amend(case, accuracy=ACCURACY)
    return folder / "scene.toml"


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


def run_up(scene: Path, facts: dict[str, Any], duration: float) -> Path:
    """Run the input from 500 to 6000 rpm at the torque of the scene and return the run.

    Both stages run at the mean misalignment that the deflection found.
    """
    settings = {
        "run.duration_s": duration,
        "drives.motor.time_s": [0.0, duration],
        "drives.motor.speed_rpm": [500.0, 6000.0],
    }
    for mesh in facts["meshes"]:
        misalignment = round(mesh["mean_misalignment_um"], 3)
        amend(scene.with_name(file_of(mesh["name"])), errors={"misalignment_um": [misalignment]})
        settings[f"meshes.{mesh['name']}.misalignment_um"] = misalignment
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


def lines(before: dict[str, Any], after: dict[str, Any], runs: tuple[Path, Path]) -> list[str]:
    """Return the table: ripple of both stages over the spectrum, then the peaks of bearing forces."""
    rows = [f"{'':34}{'before':>10}{'after':>10}"]
    for old, new in zip(before["meshes"], after["meshes"], strict=True):
        pair = old["mean_peak_to_peak_um"], new["mean_peak_to_peak_um"]
        rows.append(f"{old['name'] + ', peak-to-peak STE, um':34}{pair[0]:10.3f}{pair[1]:10.3f}")
    levels = [peak_levels(run) for run in runs]
    for name in levels[0]:
        rows.append(f"{name + ', N':34}{levels[0][name]:10.1f}{levels[1][name]:10.1f}")
    return rows


def main() -> None:
    """Open, deflect, optimize, deflect, run up, compare."""
    parser = argparse.ArgumentParser(description="A two-stage unit over its load spectrum.")
    parser.add_argument("-o", "--output", type=Path, default=Path("two_stage"), help="folder to write")
    parser.add_argument("--quick", action="store_true", help="few designs, a short run")
    options = parser.parse_args()
    effort, folder = QUICK if options.quick else THOROUGH, options.output

    scene = opened(folder / "before")
    before = deflected(scene, folder / "deflected")
    worst = max(before["meshes"], key=lambda mesh: float(mesh["mean_peak_to_peak_um"]))["name"]
    best = optimized(worst, folder / "deflected", effort)
    better = shutil.copytree(folder / "before", folder / "after", dirs_exist_ok=True) / "scene.toml"
    shutil.copy(best, better.with_name(file_of(worst)))
    after = deflected(better, folder / "deflected_after")
    print(
        f"deflected in {before['cpu_seconds']:.1f} and {after['cpu_seconds']:.1f} CPU s; optimized: {worst}"
    )
    runs = run_up(scene, before, effort.duration), run_up(better, after, effort.duration)
    print(*lines(before, after, runs), sep="\n")
    for name, run in zip(("before", "after"), runs, strict=True):
        loa("report", run, "-o", folder / f"run_up_{name}.html")


if __name__ == "__main__":
    main()
