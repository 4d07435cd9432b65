"""Small inputs whose work is done in parts: a case in the plane, and a search of better flanks."""

from typing import Any

GEAR = {"teeth": 20, "face_width_mm": 10.0, "bore_diameter_mm": 40.0, "thickness_allowance_um": 60.0}
CASE: dict[str, Any] = {
    "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": GEAR, "wheel": GEAR},
    "load": {"torque_n_m": [40.0, 80.0]},
    "accuracy": {"level": "draft", "model": "plane_strain", "positions": 16},
}
SEARCH = {
    "variables": {"pinion": {"profile_crowning_um": [0.0, 20.0]}},
    "search": {"method": "nelder_mead", "starts": 2, "evaluations": 8, "positions": 16},
}
