"""Scenes of a study: each is the scene of its own file to the last bit, and shares what its values leave."""

import json
import math
import sys
from itertools import chain
from typing import Any

import numpy as np
import pytest

from dynamics import RunResult, Scene, simulate
from dynamics.simulation import run_scene, undescribed
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.study.scenes import VariedScene, places_of, scene_of_json, with_value
from model_studies import LeftOut

Json = dict[str, Any]
TEETH, FACE = (20, 30), 20.0
SHAFT = {"length_mm": 80.0, "diameter_mm": 30.0}
BUSHING = {"radial_stiffness_n_per_m": 2e8, "axial_stiffness_n_per_m": 1e8}
CATALOG = {"bore_mm": 25.0, "outside_diameter_mm": 62.0, "static_rating_n": 11600.0, "clearance_um": 10.0}
UNIT: Json = {
    "run": {"duration_s": 0.01},
    "shafts": [
        SHAFT | {"name": "in"},
        SHAFT | {"name": "out", "origin_mm": [sum(TEETH), 0.0, 0.0]},
    ],
    "gears": [
        {"name": "pinion", "shaft": "in", "position_mm": 40.0, "bore_diameter_mm": 30.0},
        {"name": "wheel", "shaft": "out", "position_mm": 40.0, "bore_diameter_mm": 30.0},
    ],
    "discs": [
        {
            "name": "rotor",
            "shaft": "in",
            "position_mm": 60.0,
            "cylinder": {"outer_diameter_mm": 60.0, "width_mm": 10.0, "bore_diameter_mm": 30.0},
        }
    ],
    "bushings": [
        BUSHING | {"name": "left", "shaft": "in", "position_mm": 0.0},
        BUSHING | {"name": "right", "shaft": "in", "position_mm": 80.0},
        BUSHING | {"name": "far", "shaft": "out", "position_mm": 80.0},
    ],
    "rolling_bearings": [{"name": "near", "shaft": "out", "position_mm": 0.0, "catalog": CATALOG}],
    "meshes": [
        {
            "name": "mesh",
            "driver": "pinion",
            "driven": "wheel",
            "damping_ratio": 0.1,
            "stiffness": {
                "teeth": list(TEETH),
                "base_radius_mm": TEETH[0] * math.cos(math.radians(20.0)),
                "working_pressure_angle_deg": 20.0,
                "face_width_mm": FACE,
                "stiffness_n_per_m": {"value": [3e8], "amplitude": [5e7]},
            },
        }
    ],
    "housings": [
        {
            "name": "case",
            "bushings": ["left", "right"],
            "stiffness_matrix": (5e8 * np.eye(6)).tolist(),
            "mass_matrix": np.eye(6).tolist(),
            "damping_ratio": 0.05,
        }
    ],
    "drives": [{"name": "motor", "shaft": "in", "speed_rpm": [1000.0]}],
    "loads": [{"name": "brake", "shaft": "out", "torque_n_m": [50.0]}],
    "unbalances": [{"name": "chip", "shaft": "in", "position_mm": 60.0, "amount_g_mm": 100.0}],
    "outputs": {"sample_rate_hz": 20000.0, "bearing_forces": True},
    "integration": {"tolerance_nm": 1.0},
}
VARIED = {
    "run.duration_s": (0.01, 0.012),
    "shafts.*.diameter_mm": (30.0, 32.0),
    "gears.wheel.bore_diameter_mm": (30.0, 28.0),
    "gears.*.position_mm": (40.0, 35.0),
    "discs.rotor.cylinder.width_mm": (10.0, 12.0),
    "bushings.*.radial_stiffness_n_per_m": (2e8, 3e8),
    "bushings.far.radial_stiffness_n_per_m": (2e8, 3e8),
    "rolling_bearings.near.catalog.clearance_um": (10.0, 12.0),
    "meshes.mesh.damping_ratio": (0.1, 0.05),
    "meshes.mesh.stiffness.stiffness_n_per_m.amplitude[0]": (5e7, 6e7),
    "housings.case.damping_ratio": (0.05, 0.02),
    "drives.motor.speed_rpm": (1000.0, -1100.0),
    "loads.brake.torque_n_m": (50.0, 60.0),
    "unbalances.chip.amount_g_mm": (100.0, 200.0),
    "outputs.sample_rate_hz": (20000.0, 25000.0),
    "integration.tolerance_nm": (1.0, 0.5),
}
"""A number of every kind of section, and two values of it."""
KINDS = (
    *("shafts", "gears", "discs", "bushings", "rolling_bearings", "meshes", "housings", "drives"),
    *("loads", "unbalances", "outputs", "integration"),
)


def varied(*paths: str) -> VariedScene:
    inputs = scene_of_json(UNIT)
    places = {path: places_of(inputs, path, path) for path in paths}
    return VariedScene(inputs.model_dump_json(), {}, places, "")


def alone(values: dict[str, float]) -> Scene:
    """Return the scene of a file with these values; nothing that is kept for others is left."""
    for name, module in list(sys.modules.items()):
        if name.startswith(("dynamics.", "lineofaction.")):
            for cell in chain.from_iterable(
                getattr(x, "__closure__", None) or () for x in vars(module).values()
            ):
                getattr(cell.cell_contents, "cache_clear", int)()
    table = json.loads(json.dumps(UNIT))
    for path, value in values.items():
        for place in places_of(scene_of_json(UNIT), path, path):
            with_value(table, place, value)
    return dynamic_scene(scene_of_json(table), {})


def check_same_series(run: RunResult, other: RunResult) -> None:
    for name in ("time", "dynamic_transmission_error", "mesh_force", "bearing_force", "drive_torque"):
        np.testing.assert_array_equal(getattr(run, name), getattr(other, name))
    assert run.receipt["sampling"] == other.receipt["sampling"]


@pytest.mark.drawn
@pytest.mark.parametrize("path", VARIED)
def test_a_run_among_others_is_the_run_alone_to_the_last_bit(path):
    scenes, (first, other) = varied(path), VARIED[path]
    runs = [run_scene(scenes.scene({path: at}), describe=undescribed) for at in (first, other, first)]
    assert not np.array_equal(runs[0].dynamic_transmission_error, runs[1].dynamic_transmission_error)
    check_same_series(runs[2], runs[0])
    check_same_series(runs[1], simulate(alone({path: other})))


@pytest.mark.parametrize("path", VARIED)
def test_scenes_share_all_parts_but_those_of_other_values(path):
    scenes, own = varied(path), path.partition(".")[0]
    first, other = (scenes.scene({path: value}) for value in VARIED[path])
    assert [kind for kind in KINDS if getattr(first, kind) is not getattr(other, kind)] == (
        [] if own == "run" else [own]
    )


def test_values_that_stay_keep_their_parts():
    speed, ratio = "drives.motor.speed_rpm", "meshes.mesh.damping_ratio"
    scenes = varied(speed, ratio)
    first, other = (scenes.scene({speed: 900.0, ratio: value}) for value in (0.05, 0.1))
    assert first.drives is other.drives and first.meshes is not other.meshes


def test_a_value_that_cannot_be_has_the_words_of_the_whole_file():
    path = "bushings.right.position_mm"
    scenes = varied(path)
    with pytest.raises(BadInput, match=r"bushings\[1\]\.position_mm"):
        scenes.inputs({path: math.inf})
    assert scenes.scene({path: 70.0}).bushings[1].position == pytest.approx(0.07)
    with pytest.raises(LeftOut, match=r"bushings\[1\]\.position_mm"):
        scenes.scene({path: 500.0})
