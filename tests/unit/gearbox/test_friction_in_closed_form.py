"""A coefficient of friction on a mesh in closed form acts."""

import math
from typing import Any

import numpy as np

from dynamics.assembly.assemble import assemble
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.schemas.scene import SceneInput


def pair(**changes: Any) -> SceneInput:
    form = {
        "teeth": [20, 30],
        "base_radius_mm": 20.0 * math.cos(math.radians(20.0)),
        "working_pressure_angle_deg": 20.0,
        "face_width_mm": 20.0,
        "stiffness_n_per_m": {"value": [2e8], "amplitude": [2e7]},
    }
    names, places = ("pinion", "wheel"), ([0.0, 0.0, 0.0], [50.0, 0.0, 0.0])
    return SceneInput.model_validate(
        {
            "run": {"duration_s": 0.1},
            "shafts": [
                {"name": name, "length_mm": 100.0, "diameter_mm": 20.0, "origin_mm": place}
                for name, place in zip(names, places, strict=True)
            ],
            "gears": [{"name": name, "shaft": name, "position_mm": 50.0} for name in names],
            "meshes": [{"name": "mesh", "driver": "pinion", "driven": "wheel", "stiffness": form} | changes],
            "drives": [{"name": "motor", "shaft": "pinion", "speed_rpm": [600.0]}],
            "loads": [{"name": "brake", "shaft": "wheel", "torque_n_m": [50.0]}],
        }
    )


def test_friction_of_a_mesh_in_closed_form_is_simulated():
    scene, without = dynamic_scene(pair(friction=0.05), {}), dynamic_scene(pair(), {})
    (entry,) = assemble(scene).ledger.of("friction")
    assert entry.on and entry.influence > 0.0
    table, plain = scene.meshes[0].table, without.meshes[0].table
    assert getattr(plain, "sliding_lever", None) is None
    at = np.searchsorted(table.position, plain.position)
    np.testing.assert_array_equal(table.stiffness[0, 0, at], plain.stiffness[0, 0])
