"""A two-stage unit over its load spectrum: the ripple of both stages in every load case, and a run-up.

    python examples/two_stage/unit.py            # tables and load cases: 1 CPU minute; then the run-up
    python examples/two_stage/unit.py --seconds 0.1

Both stages run aligned; the shafts of the run-up bend and tilt on their bearings.
"""

from __future__ import annotations

import argparse
import tomllib
from dataclasses import replace
from pathlib import Path

from dynamics.simulation import simulate
from fe_contact import SteDatabase, ste_database
from service.client.portable import case_of_mesh, scene_of
from service.convert.case import analysis_options, gear_pair, table_axes
from service.convert.scene import dynamic_scene
from service.schemas.scene import SceneInput

UNIT = Path(__file__).parent


def stage_tables(given: SceneInput, folder: Path) -> dict[str, SteDatabase]:
    """Compute the transmission error of every stage over its torques."""
    tables = {}
    for index, mesh in given.with_database:
        case = case_of_mesh(mesh, f"meshes[{index}]", folder)
        assert case is not None
        tables[mesh.name] = ste_database(gear_pair(case), table_axes(case), analysis_options(case))
    return tables


def spectrum_lines(tables: dict[str, SteDatabase]) -> list[str]:
    """Say the peak-to-peak transmission error of every stage in every load case."""
    lines = []
    for case in tomllib.loads((UNIT / "load_cases.toml").read_text("utf-8"))["load_cases"]:
        torque, found = case["torque_n_m"], []
        for name, table in tables.items():
            ripple = table.peak_to_peak(torque=torque)
            found.append(f"{name} {1e6 * ripple.value:.3f} +- {1e6 * ripple.error:.3f} um")
            torque *= table.facts.teeth[1] / table.facts.teeth[0]
        lines.append(f"{case['name']}, {case['share']:.0%} of the time: {', '.join(found)}")
    return lines


def main() -> None:
    """Compute, print, run up, write."""
    parser = argparse.ArgumentParser(description="A two-stage unit over its load spectrum.")
    parser.add_argument("--seconds", type=float, default=1.0, help="of the run-up that are integrated")
    parser.add_argument("-o", "--output", type=Path, default=Path("two_stage.nc"), help="file of the run")
    asked = parser.parse_args()

    given, folder = scene_of(UNIT / "scene.toml")
    tables = stage_tables(given, folder)
    print(*spectrum_lines(tables), sep="\n")
    run = simulate(replace(dynamic_scene(given, tables), duration=asked.seconds))
    run.to_netcdf(asked.output)
    status = run.status.name.lower()
    print(f"run-up {status}, energy balance {run.energy.relative:.1e}; written to {asked.output}")


if __name__ == "__main__":
    main()
