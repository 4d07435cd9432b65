"""The pair of Palermo et al. on catalog bearings, as a scene file states it."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
from small_table import small_table

from dynamics import Integration, simulate
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput

EXAMPLE = Path(__file__).parents[3] / "examples" / "palermo_scene.toml"
LINE = {"bore_mm": 40.0, "outside_diameter_mm": 80.0, "static_rating_n": 19000.0, "clearance_um": 10.0}
SPEED = 600.0  # rpm


def on_catalog_bearings():
    """The example at constant speed on four 6208."""
    table = tomllib.loads(EXAMPLE.read_text())
    place = ("name", "shaft", "position_mm")
    table["rolling_bearings"] = [
        {name: bushing[name] for name in place} | {"catalog": LINE, "axial_preload_n": 100.0 * (-1) ** index}
        for index, bushing in enumerate(table.pop("bushings"))
    ]
    table["drives"][0] |= {"time_s": [0.0], "speed_rpm": [SPEED]}
    table["run"]["duration_s"] = 0.05
    return dynamic_scene(validated(SceneInput, table), {"mesh": small_table()})


def test_the_example_on_catalog_bearings_is_stable_and_the_same_by_both_integrators(record_figure):
    scene = on_catalog_bearings()
    runs = [
        simulate(replace(scene, integration=Integration(method=method, tolerance=1e-10)))
        for method in ("explicit", "implicit")
    ]
    assert all(run.status.usable for run in runs)
    force = [run.mesh_force[0] for run in runs]
    apart = float(np.max(np.abs(force[1] - force[0])) / np.max(force[0]))
    record_figure("integrators on catalog bearings", apart, "at most 1e-4", "1", "largest mesh force")
    assert apart < 1e-4
    bearing = [run.bearing_force for run in runs]
    largest = np.max(np.abs(bearing[0]))
    assert np.max(np.abs(bearing[1] - bearing[0])) < 1e-4 * largest
    assert np.ptp(force[0]) > 5e-4 * np.max(force[0])  # it vibrates
    assert max(run.energy.relative for run in runs) < 1e-3
    names = [entry["effect"] for entry in runs[0].effect_ledger["entries"] if entry["on"]]
    assert "bearing_clearance" in names
