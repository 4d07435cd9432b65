"""Phases of trains of scene files: thickness from the tables, stated angles, contradictions by field."""

import copy
import math
from typing import Any

import pytest

from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.mechanism.train_phases import TrainPhases, train_phases
from dynamics.scene import Scene
from fe_contact.ste import PairGeometry
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput

APART = 40.0


def shaft(name: str, x: float) -> dict[str, Any]:
    return {"name": name, "length_mm": 100.0, "diameter_mm": 20.0, "origin_mm": [x, 0.0, 0.0]}


def stiff_mesh(name: str, driver: str, driven: str, **changes: Any) -> dict[str, Any]:
    form = {
        "teeth": [20, 20],
        "base_radius_mm": 0.5 * APART * math.cos(math.radians(20.0)),
        "working_pressure_angle_deg": 20.0,
        "face_width_mm": 20.0,
        "stiffness_n_per_m": {"value": [2e8]},
    }
    return {"name": name, "driver": driver, "driven": driven, "stiffness": form, **changes}


def chain() -> dict[str, Any]:
    """Three gears of 20 teeth in a row."""
    names = ("a", "b", "c")
    return {
        "run": {"duration_s": 0.1},
        "shafts": [shaft(name, APART * index) for index, name in enumerate(names)],
        "gears": [{"name": name, "shaft": name, "position_mm": 50.0} for name in names],
        "meshes": [stiff_mesh("first", "a", "b"), stiff_mesh("second", "b", "c")],
        "drives": [{"name": "motor", "shaft": "a", "speed_rpm": [600.0]}],
    }


def scene_of(file: dict[str, Any], facts: dict[str, PairGeometry] | None = None) -> Scene:
    return check_scene(SceneInput.model_validate(file), facts or {})


def phases_of(scene: Scene) -> TrainPhases:
    return train_phases(scene, solve_kinematics(scene).mesh_sense)


def test_a_chain_in_closed_form_shifts_by_half_a_pitch_and_by_what_its_coast_flank_says():
    assert phases_of(scene_of(chain())).position == pytest.approx([0.0, 0.5], abs=1e-9)
    file = chain()
    file["meshes"][0]["coast_flank"] = {"backlash_um": 100.0, "tooth_thickness": 0.45}
    pitch = 2.0 * math.pi * file["meshes"][0]["stiffness"]["base_radius_mm"] / 20
    driven = 1.0 - 0.45 - 0.1 / pitch
    assert phases_of(scene_of(file)).position == pytest.approx([0.0, driven], abs=1e-9)


def test_a_position_off_the_geometry_is_refused_by_the_field_of_the_file():
    file = chain()
    file["meshes"][1]["position_offset"] = 0.48
    file["gears"].append({"name": "d", "shaft": "d", "position_mm": 50.0})
    file["shafts"].append(shaft("d", 0.0) | {"origin_mm": [APART, APART, 0.0]})
    file["meshes"].append(stiff_mesh("third", "b", "d", position_offset=0.1))
    with pytest.raises(BadInput, match=r"meshes\[2\].position_offset.*0\.1.*must be 0\.48"):
        scene_of(file)


def test_angles_of_a_shaft_are_degrees_one_for_each_gear():
    file = chain()
    file["gears"].append({"name": "b2", "shaft": "b", "position_mm": 80.0})
    file["gears"][2] |= {"position_mm": 80.0}
    file["meshes"][1]["driver"] = "b2"
    assert phases_of(scene_of(file)).angles[0].gears == ("b", "b2")
    aligned = phases_of(scene_of(file)).position[1]
    file["shafts"][1]["tooth_angles_deg"] = [1.0, 4.6]  # a fifth of the pitch of 18 degrees
    phases = phases_of(scene_of(file))
    assert phases.angles == ()
    assert abs((phases.position[1] - aligned) % 1.0 - 0.8) < 1e-9  # b turns in -z
    wrong = copy.deepcopy(file)
    wrong["shafts"][1]["tooth_angles_deg"] = [1.0]
    with pytest.raises(BadInput, match=r"shafts\[1\].tooth_angles_deg.*b, b2"):
        scene_of(wrong)
