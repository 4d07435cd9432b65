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
from pathlib import Path
from typing import Any

import numpy as np
from effort import QUICK, THOROUGH, Effort
from gear_case import points
from sound import deciding, levels, verdict, write_sounds

from dynamics.noise import RadiatedSound, loudest
from dynamics.orders import order_track
from dynamics.results import RunResult
from lineofaction.gearbox.schemas.toml import toml_text
from lineofaction.gearbox.units import RPM

UNIT = Path(__file__).parent
ORDERS = 3
"""Multiples of each mesh frequency that are compared."""
ORDER_OF = {"first stage": 1.0, "second stage": 21.0 / 63.0}
"""Mesh frequencies over that of the first stage: teeth of pinion 2 over those of wheel 1."""
SPEEDS = 500.0, 6000.0
"""Of the run-up, rpm of the input."""

ACCURACY = {"level": "draft"}
"""Of the cases: REXS states none."""
TRAVEL = "effects.moving_application_point"
"""Travel of the load along the face, which excites shafts and bearings beside the transmission error."""
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
    loa("open", UNIT / "two_stage.rexs", "-o", folder)
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
    loa("housing", scene, step, "--material", "spheroidal_cast_iron", "-o", scene)
    (case,) = tomllib.loads(scene.read_text("utf-8"))["housings"]
    settings = {"modes": effort.modes, "element_size_mm": effort.element_size_mm, "points": points()}
    amend(scene, housings=[case | settings])


def deflected(scene: Path, output: Path) -> dict[str, Any]:
    """Deflect the unit over its load spectrum and return the figures."""
    facts = json.loads(loa("deflect", scene, scene.with_name("load_cases.toml"), "-o", output, "--json"))
    return dict(facts)


def file_of(stage: str) -> str:
    """Return the name of a stage's case file."""
    return f"{stage.replace(' ', '_')}.toml"


def optimized(scene: Path, stage: str, output: Path, effort: Effort) -> Path:
    """Search the flanks of a stage that are heard least over the load spectrum and return its best case.

    The scene is the one with cases: each load is heard at the misalignment of its own deflection.
    """
    first, last, step = map(float, effort.speed_rpm.split(":"))
    loads = tomllib.loads(scene.with_name("load_cases.toml").read_text("utf-8"))["load_cases"]
    heard = {
        "mesh": stage,
        "speed_rpm": np.arange(first, last + 0.5 * step, step).tolist(),
        "orders": ORDERS,
        "load_cases": loads,
    }
    study = output / "study.toml"
    flanks = (UNIT / "flanks.toml").read_text("utf-8")
    study.write_text(f"{flanks}\n{toml_text({'search': effort.search, 'heard': heard})}", "utf-8")
    loa("optimize", scene, study, "-o", output / "best.toml")
    return output / "best.toml"


def at_load(facts: dict[str, Any]) -> dict[str, Any]:
    """Return the figures under the load of the scene: the load case of the largest share."""
    return dict(max(facts["load_cases"], key=lambda case: float(case["share"])))


def aligned(scene: Path, facts: dict[str, Any]) -> None:
    """Give both meshes tables at the misalignment that the deflection found at the load of the scene."""
    meshes = tomllib.loads(scene.read_text("utf-8"))["meshes"]
    for mesh, found in zip(meshes, at_load(facts)["meshes"], strict=True):
        misalignment, case = round(found["misalignment_um"], 3), scene.with_name(mesh.pop("case_file"))
        table = case.with_suffix(".nc")
        loa("analyze", case, f"--set=errors.misalignment_um=[{misalignment}]", "-o", table)
        mesh |= {"database_file": table.name, "misalignment_um": misalignment}
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


def harmonic(facts: dict[str, Any], stage: str, number: int) -> float:
    """Return a harmonic, one of the first five, of a stage's STE at the load of the scene, µm."""
    mesh = next(mesh for mesh in at_load(facts)["meshes"] if mesh["name"] == stage)
    return float(mesh["flanks"]["harmonics_um"][number - 1])


def ripples(before: dict[str, Any], after: dict[str, Any], source: tuple[str, int]) -> list[str]:
    """Return the table of both stages' ripple over the spectrum, and of the harmonic that is heard."""
    rows = {
        f"{old['name']}, peak-to-peak STE, µm": (old["mean_peak_to_peak_um"], new["mean_peak_to_peak_um"])
        for old, new in zip(before["meshes"], after["meshes"], strict=True)
    }
    stage, number = source
    rows[f"{stage}, harmonic {number} when heard, µm"] = harmonic(before, *source), harmonic(after, *source)
    table = [f"{name:44}{old:10.3f}{new:10.3f}" for name, (old, new) in rows.items()]
    return [f"{'':44}{'before':>10}{'after':>10}", *table]


def force_peaks(*runs: Path) -> list[str]:
    """Return the rows of the peaks of bearing forces in two runs."""
    before, after = map(peak_levels, runs)
    return [f"{name + ', N':44}{before[name]:10.1f}{after[name]:10.1f}" for name in before]


def heard(scene: Path, effort: Effort, name: str, *settings: str) -> RadiatedSound:
    """Find the sound power of a scene over speed and write it beside the scene.

    Designs are compared: a line that boundary elements correct in one may be left as it is in the other.
    """
    file, range_of = (
        scene.with_name(f"{name}.nc"),
        ("--speed-rpm", effort.speed_rpm, "--orders", effort.orders),
    )
    loa("noise", scene, *range_of, "--no-boundary-elements", *settings, "-o", file)
    return RadiatedSound.from_netcdf(file)


def sounds_of(scene: Path, effort: Effort) -> tuple[RadiatedSound, RadiatedSound]:
    """Return the sound of a scene, with its map and page, and that of its transmission errors alone."""
    sound, images = heard(scene, effort, "sound", effort.band), scene.with_name("sound")
    loa("report", f"{images}.nc", "-o", f"{images}.html", "--images", images)
    return sound, heard(scene, effort, "sound_of_ste", "--no-band", f"--set={TRAVEL}=off")


def pictured(folder: Path, scene: Path, sound: RadiatedSound, effort: Effort) -> None:
    """Draw the first mode of the case, and how it moves in its loudest order."""
    (point,) = loudest(sound, 1)
    at = "--speed-rpm", point.speed / RPM, "--orders", effort.orders, "--at-order", point.order
    for name, shape in {"mode_1": (*at, "--mode", 1), "velocity": at}.items():
        loa("vibration", scene, *shape, "-o", folder / f"{name}.png")
    loa("vibration", scene, *at, "-o", folder / "velocity.vtu")


def main() -> None:
    """Open, deflect, listen, optimize the stage that is heard, deflect and listen again, run up, compare."""
    parser = argparse.ArgumentParser(description="A two-stage unit over its load spectrum.")
    parser.add_argument("-o", "--output", type=Path, default=Path("two_stage"), help="folder to write")
    parser.add_argument("--quick", action="store_true", help="coarse case, few designs, no runs")
    options = parser.parse_args()
    effort, folder = QUICK if options.quick else THOROUGH, options.output

    scene = opened(folder / "before", effort)
    better = shutil.copytree(folder / "before", folder / "after", dirs_exist_ok=True) / "scene.toml"
    before = deflected(scene, folder / "deflected")
    cased = Path(shutil.copy(scene, scene.with_name("cased.toml")))
    aligned(scene, before)
    old, old_ste = sounds_of(scene, effort)
    source = deciding(old, ORDER_OF)
    stage, _ = source
    best = optimized(cased, stage, folder / "deflected", effort)
    shutil.copy(best, better.with_name(file_of(stage)))
    after = deflected(better, folder / "deflected_after")
    aligned(better, after)
    new, new_ste = sounds_of(better, effort)
    print(f"optimized: {stage}")
    print(*ripples(before, after, source), sep="\n")
    print(*levels(old, new, ORDER_OF), sep="\n")
    harmonics = harmonic(before, *source), harmonic(after, *source)
    print(*verdict(source, ORDER_OF, harmonics, (old, new), (old_ste, new_ste)), sep="\n")
    write_sounds(folder, {"before": old, "after": new}, HEARD)
    pictured(folder, scene, old, effort)
    if effort.duration:
        run_ups(folder, {"before": scene, "after": better}, effort.duration)


def run_ups(folder: Path, scenes: dict[str, Path], duration: float) -> None:
    """Run both designs up, print the peaks of their bearing forces, write their pages."""
    runs = {name: run_up(scene, duration) for name, scene in scenes.items()}
    print(*force_peaks(runs["before"], runs["after"]), sep="\n")
    for name, run in runs.items():
        loa("report", run, "-o", folder / f"run_up_{name}.html")


if __name__ == "__main__":
    main()
