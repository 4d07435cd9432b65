"""Are flanks searched by sound ever louder than flanks of least peak-to-peak? Six drawn helical pairs."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

import lineofaction as loa
from benchmarks.figures import Figure
from host.directories import cache_home
from lineofaction.gearbox.studies.change.question import flank_mesh
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.optimize import Inputs
from lineofaction.gearbox.studies.optimize.run import request_of
from lineofaction.gearbox.studies.optimize.sound_search import sound_problem
from lineofaction.gearbox.workbench import tabled

SUBJECT = "flanks searched by sound against flanks of least peak-to-peak"
FREE = {
    "pinion": {"tip_relief_um": [0, 10], "helix_crowning_um": [0, 8], "helix_slope_um": [-8, 8]},
    "wheel": {"tip_relief_um": [0, 10]},
}
SEARCH = {"evaluations": 60, "sample": 16, "trials": 1}
LIMITS = {"edge_load_share": 0.05}
HEARD = {"speed_rpm": np.arange(1000.0, 12001.0, 250.0).tolist(), "orders": 3, "misalignment_um": [0.0]}


class DrawnPair(NamedTuple):
    """Teeth, helix angle in degrees, face width in mm, torque on the pinion in N m; module 1 mm."""

    teeth: tuple[int, int]
    helix_deg: float
    width_mm: float
    torque_n_m: float


PAIRS = (
    DrawnPair((23, 41), 24.9, 12.1, 4.7),
    DrawnPair((25, 26), 18.1, 11.3, 3.3),
    DrawnPair((19, 25), 28.0, 13.2, 4.4),
    DrawnPair((20, 33), 27.6, 15.2, 8.1),
    DrawnPair((20, 28), 20.4, 15.7, 3.6),
    DrawnPair((21, 35), 16.4, 12.0, 5.2),
)
"""Drawn evenly: 19 to 25 over 25 to 44 teeth, 12 to 28 degrees, 8 to 16 mm, 3 to 9 N m."""


def figures() -> list[Figure]:
    """Return how much quieter flanks by sound are, and by how much they are louder beyond the error."""
    levels = [heard_levels(pair) for pair in PAIRS]
    rows = [
        Figure(
            SUBJECT, f"{pair.teeth[0]}/{pair.teeth[1]}, {pair.helix_deg:g} deg: quieter", ripple - own, "dB"
        )
        for pair, (own, _, ripple) in zip(PAIRS, levels, strict=True)
    ]
    louder = max(own - ripple - error for own, error, ripple in levels)
    return [*rows, Figure(SUBJECT, "louder beyond the stated error, at most", max(louder, 0.0), "dB", 0.0)]


def heard_levels(pair: DrawnPair) -> tuple[float, float, float]:
    """Return the level of flanks by sound, its error, and that of flanks of least peak-to-peak, dB."""
    scene = two_shafts(pair)
    case = scene["meshes"][0]["case"]
    own = {"variables": FREE, "search": SEARCH, "limits": LIMITS}
    ripple = loa.optimize(case, own | {"torque_n_m": [pair.torque_n_m]})
    by_level = loa.optimize(scene, own | {"heard": HEARD})
    return (
        by_level.optimum.objective.value,
        by_level.optimum.objective.error,
        _level(scene, ripple.optimum.values),
    )


def _level(scene: dict[str, Any], values: dict[str, float]) -> float:
    """Return how loud flanks are in a scene, dB."""
    study = Inputs.model_validate({"variables": FREE, "search": SEARCH, "heard": HEARD})
    subject = tabled(scene)
    mesh = flank_mesh(subject.inputs, None)
    assert mesh.case is not None and study.heard is not None
    request, means = request_of(mesh.case, study), Means(cache_home(), lambda _stage, _part: None)
    problem = sound_problem(subject, mesh, study.heard, request, np.zeros(1), means).problem
    return problem.evaluated(values)[0]


def two_shafts(pair: DrawnPair) -> dict[str, Any]:
    """Return a scene of two elastic shafts on four bushings."""
    distance = round(sum(pair.teeth) / 2.0 / np.cos(np.radians(pair.helix_deg)), 6)
    flank = {"tip_relief_um": 4.0, "tip_relief_length_mm": 0.4, "helix_crowning_um": 2.0}
    body = {"face_width_mm": pair.width_mm, "bore_diameter_mm": 8.0} | flank
    pinion, wheel = (body | {"teeth": teeth} for teeth in pair.teeth)
    sizes = {"normal_module_mm": 1.0, "helix_angle_deg": pair.helix_deg, "center_distance_mm": distance}
    case = {
        "pair": sizes | {"pinion": pinion, "wheel": wheel},
        "load": {"torque_n_m": [0.5 * pair.torque_n_m, pair.torque_n_m]},
        "accuracy": {"level": "draft", "model": "3d", "positions": 64},
    }
    springs = {"radial_stiffness_n_per_m": 1e8, "axial_stiffness_n_per_m": 1e8, "damping_ratio": 0.05}
    shafts = {"input": 0.0, "output": distance}
    ratio = pair.teeth[1] / pair.teeth[0]
    return {
        "run": {"duration_s": 0.01},
        "shafts": [
            {"name": name, "length_mm": 200.0, "diameter_mm": 10.0, "origin_mm": [x, 0.0, 0.0]}
            for name, x in shafts.items()
        ],
        "gears": [
            {"name": gear, "shaft": shaft, "position_mm": 100.0, "bore_diameter_mm": 10.0}
            for gear, shaft in zip(("pinion", "wheel"), shafts, strict=True)
        ],
        "bushings": [
            {"name": f"{shaft} at {at:g}", "shaft": shaft, "position_mm": at} | springs
            for shaft in shafts
            for at in (0.0, 200.0)
        ],
        "meshes": [
            {"name": "mesh", "driver": "pinion", "driven": "wheel", "case": case, "damping_ratio": 0.15}
        ],
        "drives": [{"name": "motor", "shaft": "input", "time_s": [0.0], "speed_rpm": [955.0]}],
        "loads": [{"name": "brake", "shaft": "output", "torque_n_m": [pair.torque_n_m * ratio]}],
        "outputs": {"sample_rate_hz": 20000.0},
    }
