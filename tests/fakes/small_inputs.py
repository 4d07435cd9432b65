"""Inputs of every process that take seconds: a small pair by the coarsest model, and few of everything."""

import copy
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

from housing_solid import write_block

from lineofaction.gearbox.schemas.file_content import FileContentInput
from service.schemas.examples import INPUTS

Json = dict[str, Any]

_GEAR: Json = {"teeth": 20, "face_width_mm": 4.0, "bore_diameter_mm": 10.0}
_DRAFT = {"level": "draft", "model": "plane_strain", "positions": 16, "receipt": "minimal"}
_CASE: Json = {
    "pair": {"normal_module_mm": 1.0, "center_distance_mm": 20.0, "pinion": _GEAR, "wheel": _GEAR},
    "load": {"torque_n_m": [0.5, 1.0]},
    "accuracy": _DRAFT,
}
_RING: Json = {"internal": True, "teeth": 60, "face_width_mm": 4.0, "rim_diameter_mm": 72.0}
_IN_RING: Json = {
    "pair": {
        "normal_module_mm": 1.0,
        "center_distance_mm": 20.0,
        "pinion": _GEAR,
        "wheel": _RING | {"addendum_coefficient": 0.8},
    },
    "load": {"torque_n_m": [0.5, 1.0]},
    "accuracy": _DRAFT,
}
_RELIEF = {"tip_relief_um": 3.0, "tip_relief_length_mm": 0.4}
_RELIEVED = _CASE | {"pair": _CASE["pair"] | {"pinion": _GEAR | _RELIEF}}
_WAVES = """\
temporal_order,spatial_order,speed_rpm,torque_n_m,radial_pressure_kpa,radial_phase_deg,\
tangential_pressure_kpa,tangential_phase_deg
20,2,300,1,30,0,4,90
48,0,300,1,12,0,2,90
48,1,300,1,1,0,0.2,90
"""
_FEW: dict[str, Json] = {
    "flank": {"torque_n_m": 1.0},
    "root-stress": {"torque_n_m": 1.0},
    "ablate": {"only": ["tooth_coupling", "corner_contact"]},
    "frontier": {"rungs": ["thin_slices", "corrected"]},
    "sensitivity": {"misalignment_um": [0.0, 5.0], "center_distance_change_percent": [0.0]},
    "optimize": {"search": {"evaluations": 8, "sample": 4, "trials": 1, "positions": 16}},
    "scatter": {"samples": 4, "limit": "1=0.5um"},
    "change": {"after": _RELIEVED, "speed_rpm": [300.0], "orders": 3, "tolerances": {"samples": 4}},
    "elastic-ring": {
        "case": _IN_RING,
        "planets": 4,
        "lugs": 6,
        "lug_radial_n_per_m": 1e8,
        "lug_tangential_n_per_m": 1e8,
    },
    "sweep": {"over": ["torque=0.5:1:0.5"], "show": ["peak_to_peak"]},
    "modes": {"speed_rpm": [0.0]},
    "response": {"speed_rpm": [300.0]},
    "complaint": {"frequency_hz": 400.0, "speed_rpm": 1200.0},
    "force-waves": {
        "force_wave_table": _WAVES,
        "bore_radius_mm": 80.0,
        "active_length_mm": 150.0,
        "speed_rpm": 300.0,
        "torque_n_m": 1.0,
    },
    "vibration": {"speed_rpm": [300.0], "mode": 1},
    "noise": {"speed_rpm": [300.0]},
    "listen": {"microphone_mm": [10.0, 10.0, 400.0]},
    "steady": {"speed_rpm": [300.0], "branch": False, "settling_periods": 1},
    "study": {
        "factors": [{"path": "loads.brake.torque_n_m", "levels": [0.5, 1.0]}],
        "responses": [{"quantity": "dte_rms"}],
    },
}
"""Beside the case or the scene; what is left out has its default."""


def small_inputs(process: str) -> Json:
    """Return the inputs of a process; those of `listen` lack the hash of its run."""
    inputs = copy.deepcopy(INPUTS[process])
    subject = {"scene": _small_scene(inputs["scene"])} if "scene" in inputs else {"case": _CASE}
    return copy.deepcopy(subject | _FEW.get(process, {}))


def _small_scene(scene: Json) -> Json:
    scene["run"]["duration_s"] = 0.01
    scene["meshes"][0]["case"] = _CASE
    scene["shafts"][1]["origin_mm"] = [20.0, 0.0, 0.0]
    for shaft in scene["shafts"]:
        shaft["diameter_mm"] = 10.0
    for gear in scene["gears"]:
        gear["bore_diameter_mm"] = 10.0
    scene["loads"][0]["torque_n_m"] = [1.0]
    for housing in scene.get("housings", ()):
        _around_two_bearings(scene, housing)
    return scene


def _around_two_bearings(scene: Json, housing: Json) -> None:
    held = [bushing for bushing in scene["bushings"] if bushing["position_mm"] == 0.0]
    for bushing in held:
        bushing["position_mm"] = 25.0
    housing["seats"] = [
        {"bearing": bushing["name"], "bore_diameter_mm": 10.0, "bore_length_mm": 7.5} for bushing in held
    ]
    housing["feet"][0]["point_mm"] = [0.0, -10.0, 0.0]
    housing["points"][0]["position_mm"] = [10.0, 10.0, 25.0]
    housing |= {"step_file": _block(), "modes": 4, "element_size_mm": 6.0}


@cache
def _block() -> Json:
    with tempfile.TemporaryDirectory() as folder:
        return FileContentInput.of(write_block(Path(folder) / "block.step", "small")).model_dump()
