"""The scene of palermo_scene.toml at constant speed, here and in Exudyn, on the same mesh-force table.

    pip install exudyn
    loa analyze examples/palermo_spur_20_20.toml -o ste.nc
    python -m benchmarks.exudyn_pair ste.nc [--rpm 900] [--seconds 0.2] [--solver RK44] [--step 5e-6]

Prints the difference of the two transmission errors and the CPU seconds of each.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.exudyn_scene import run_in_exudyn
from dynamics.loads import TimeLaw
from dynamics.scene import Outputs, Scene
from dynamics.simulation import simulate
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.subjects import scene_of

SCENE = Path(__file__).parents[1] / "examples" / "palermo_scene.toml"


def main() -> None:
    """Run both and compare."""
    arguments = _arguments()
    scene = constant_speed_scene(SteDatabase.from_netcdf(arguments.table), arguments.rpm, arguments.seconds)
    simulate(replace(scene, duration=1e-3))  # compiles where nothing is cached yet
    began = time.process_time()
    own = simulate(scene)
    seconds = time.process_time() - began
    other = run_in_exudyn(scene, solver=arguments.solver, step=arguments.step)
    error = own.dynamic_transmission_error[0]
    apart = np.interp(own.time, other.time, other.dynamic_transmission_error) - error
    relative = float(np.sqrt(np.mean(apart**2)) / np.std(error))
    print(f"transmission error swings by {1e6 * float(np.std(error)):.3f} µm rms")
    print(f"Exudyn differs by {100.0 * relative:.3g} % of it")
    print(f"CPU: {seconds:.3f} s here, {other.cpu_seconds:.3f} s in Exudyn's {arguments.solver}")


def constant_speed_scene(table: SteDatabase, rpm: float, seconds: float) -> Scene:
    """Return the scene with its drive at constant speed and nothing stored but the mesh."""
    given, _ = scene_of(SCENE)
    scene = dynamic_scene(given, {mesh.name: table for mesh in given.meshes})
    drive = replace(scene.drives[0], speed=TimeLaw.constant(rpm * math.pi / 30.0))
    outputs = Outputs(20e3, bearing_forces=False, energy_audit=False, anti_alias=False)
    return replace(scene, drives=(drive,), duration=seconds, outputs=outputs)


def _arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="One pair in two engines.")
    parser.add_argument("table", type=Path, help="STE database of the pair")
    parser.add_argument("--rpm", type=float, default=900.0)
    parser.add_argument("--seconds", type=float, default=0.2)
    parser.add_argument("--solver", default="RK44")
    parser.add_argument("--step", type=float, default=5e-6)
    return parser.parse_args()


if __name__ == "__main__":
    main()
