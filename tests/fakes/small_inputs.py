"""Inputs of every process that take seconds: a small pair by the coarsest model, and few of everything."""

from __future__ import annotations

import copy
from typing import Any

from service.schemas.request_examples import INPUTS

Json = dict[str, Any]

_GEAR: Json = {"teeth": 20, "face_width_mm": 4.0, "bore_diameter_mm": 10.0}
_DRAFT = {"level": "draft", "model": "plane_strain", "positions": 16, "receipt": "minimal"}
_CASE: Json = {
    "pair": {"normal_module_mm": 1.0, "center_distance_mm": 20.0, "pinion": _GEAR, "wheel": _GEAR},
    "load": {"torque_n_m": [0.5, 1.0]},
    "accuracy": _DRAFT,
}
_FEW: dict[str, Json] = {
    "flank": {"torque_n_m": 1.0},
    "root-stress": {"torque_n_m": 1.0},
    "ablate": {"only": ["tooth_coupling", "corner_contact"]},
    "frontier": {"rungs": ["thin_slices", "corrected"]},
    "sensitivity": {"misalignment_um": [0.0, 5.0], "center_distance_change_percent": [0.0]},
    "optimize": {"search": {"evaluations": 8, "sample": 4, "trials": 1, "positions": 16}},
    "scatter": {"samples": 4},
    "sweep": {"over": ["torque=0.5:1:0.5"], "show": ["peak_to_peak"]},
    "modes": {"speed_rpm": [0.0]},
    "response": {"speed_rpm": [300.0]},
    "steady": {"speed_rpm": [300.0], "branch": False, "settling_periods": 1},
    "study": {
        "factors": [{"path": "loads.brake.torque_n_m", "levels": [0.5, 1.0]}],
        "responses": [{"quantity": "dte_rms"}],
    },
}
"""Beside the case or the scene; what is left out has its default."""


def small_inputs(process: str) -> Json:
    """Return the inputs of a process."""
    inputs = copy.deepcopy(INPUTS[process])
    if "scene" in inputs:
        return {"scene": _small_scene(inputs["scene"])} | _FEW.get(process, {})
    return {"case": _CASE} | _FEW.get(process, {})


def _small_scene(scene: Json) -> Json:
    """Let a scene be short, and its pair the small one."""
    scene["run"]["duration_s"] = 0.01
    scene["meshes"][0]["case"] = _CASE
    scene["shafts"][1]["origin_mm"] = [20.0, 0.0, 0.0]
    for shaft in scene["shafts"]:
        shaft["diameter_mm"] = 10.0
    for gear in scene["gears"]:
        gear["bore_diameter_mm"] = 10.0
    scene["loads"][0]["torque_n_m"] = [1.0]
    return scene
