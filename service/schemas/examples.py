"""Bodies of requests, as they are shown in the description."""

from __future__ import annotations

from base64 import b64encode
from typing import Any
from zlib import compress

from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.study import Study
from service.schemas.housing_example import MESHED_HOUSING

Json = dict[str, Any]

_GEAR = {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0}
CASE: Json = {
    "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": _GEAR, "wheel": _GEAR},
    "load": {"torque_n_m": [10.0, 50.0, 100.0, 200.0, 400.0]},
}
"""The spur pair of Palermo et al., ISMA 2010."""

INTERNAL_CASE: Json = {
    "pair": {
        "normal_module_mm": 2.0,
        "center_distance_mm": 60.0,
        "pinion": {"teeth": 36, "face_width_mm": 20.0, "bore_diameter_mm": 30.0},
        "wheel": {
            "internal": True,
            "teeth": 96,
            "face_width_mm": 20.0,
            "rim_diameter_mm": 212.0,
            "addendum_coefficient": 0.9,
        },
    },
    "load": {"torque_n_m": [50.0, 100.0]},
}
"""A planet in its ring."""

QUERY: Json = {"position": [0.0, 0.25], "deflection_um": [5.0, 7.5]}
_SCENE_FILE = """[run]
duration_s = 0.1
[[shafts]]
name = "input"
length_mm = 200.0
diameter_mm = 40.0
[[shafts]]
name = "output"
length_mm = 200.0
diameter_mm = 40.0
origin_mm = [80.0, 0.0, 0.0]
[[gears]]
name = "pinion"
shaft = "input"
position_mm = 100.0
bore_diameter_mm = 40.0
[[gears]]
name = "wheel"
shaft = "output"
position_mm = 100.0
bore_diameter_mm = 40.0
[[meshes]]
name = "mesh"
driver = "pinion"
driven = "wheel"
database_hash = "9b4f26e85c1a7d30e8f2b6c4a1d93e57f08b2c6d4e5a7193c8d0f1e2b3a49567"
[[drives]]
name = "motor"
shaft = "input"
time_s = [0.0]
speed_rpm = [955.0]
"""
_REXS_FILE = (
    b'<model version="2.0.0" applicationId="hand" applicationVersion="1" date="2026-01-01">'
    b'<relations/><components><component id="1" type="gear_unit"/></components></model>'
)
DRAFTS = {
    **{f"/v1/drafts/{name}": f"/v1/cases/{name}" for name in ("outline", "to-toml", "as-made")},
    **{"/v1/drafts/plan": "/v1/plans", "/v1/drafts/{key}/ste": "/v1/databases/{key}/ste"},
    "/v1/drafts/scene": "/v1/scenes/to-files",
    "/v1/drafts/scene-text": "/v1/scenes/from-toml",
    "/v1/drafts/housing-surface": "/v1/scenes/housing-surface",
}
"""Paths of questions about drafts, by the paths whose examples of bodies and answers they share."""


def _bushing(shaft: str, position_mm: float) -> Json:
    return {
        "name": f"{shaft} at {position_mm:g}",
        "shaft": shaft,
        "position_mm": position_mm,
        "radial_stiffness_n_per_m": 1e8,
        "axial_stiffness_n_per_m": 1e8,
        "damping_ratio": 0.05,
    }


SCENE: Json = {
    "run": {"duration_s": 0.1},
    "shafts": [
        {"name": name, "length_mm": 200.0, "diameter_mm": 40.0, "origin_mm": [x, 0.0, 0.0]}
        for name, x in (("input", 0.0), ("output", 80.0))
    ],
    "gears": [
        {"name": name, "shaft": shaft, "position_mm": 100.0, "bore_diameter_mm": 40.0}
        for name, shaft in (("pinion", "input"), ("wheel", "output"))
    ],
    "bushings": [_bushing(shaft, position) for shaft in ("input", "output") for position in (0.0, 200.0)],
    "meshes": [{"name": "mesh", "driver": "pinion", "driven": "wheel", "case": CASE, "damping_ratio": 0.15}],
    "drives": [{"name": "motor", "shaft": "input", "time_s": [0.0], "speed_rpm": [955.0]}],
    "loads": [{"name": "brake", "shaft": "output", "torque_n_m": [100.0]}],
    "outputs": {"sample_rate_hz": 20000.0},
}


HOUSED_SCENE: Json = SCENE | {
    "housings": [
        {
            "name": "case",
            "step_file": {"name": "case.step", "content": b64encode(compress(b"ISO-10303-21;")).decode()},
            "material": "gray_cast_iron",
            "seats": [
                {"bearing": bushing["name"], "bore_diameter_mm": 62.0, "bore_length_mm": 18.0}
                for bushing in SCENE["bushings"]
            ],
            "feet": [{"name": "base", "point_mm": [0.0, -60.0, 0.0], "normal": [0.0, -1.0, 0.0]}],
            "points": [{"name": "cover", "position_mm": [40.0, 60.0, 100.0]}],
        }
    ]
}
"""The scene in a housing by its solid, of whose file only the beginning is shown."""


def _example(study: Study) -> Json:
    """Return inputs of a study: every field that has an example."""
    scene = HOUSED_SCENE if study.housed else SCENE
    case = INTERNAL_CASE if study.internal else CASE
    subject = {"scene": scene} if study.takes.subject == "scene" else {"case": case}
    fields = study.inputs.model_fields.items()
    return subject | {name: field.examples[0] for name, field in fields if field.examples}


INPUTS: dict[str, Json] = {
    "analyze": {"case": CASE},
    "simulate": {"scene": SCENE},
    **{name: _example(study) for name, study in STUDIES.items()},
}
"""Inputs of an execution, by process."""


BODIES: dict[str, Json] = {
    "/v1/jobs/{job_id}": {"title": "Tip relief 20 µm", "tags": ["ev-3", "draft"]},
    "/v1/batches": {
        "process": "analyze",
        "inputs": {"case": CASE},
        "jobs": [
            {"case": {"pair": {"pinion": {"tip_relief_um": um, "tip_relief_length_mm": 1.5}}}}
            for um in (10.0, 20.0)
        ],
    },
    "/v1/databases/{key}/query": QUERY,
    "/v1/databases/{key}/ste": {"torque_n_m": [100.0], "pinion": {"tip_relief_um": 10.0}},
    **{path: {"inputs": {"case": CASE}} for path in ("/v1/plans", "/v1/cases/outline", "/v1/cases/to-toml")},
    "/v1/cases/from-toml": {
        "toml": "[pair]\nnormal_module_mm = 4.0\ncenter_distance_mm = 80.0\n"
        "[pair.pinion]\nteeth = 20\nface_width_mm = 25.0\nbore_diameter_mm = 40.0\n"
        "[pair.wheel]\nteeth = 20\nface_width_mm = 25.0\nbore_diameter_mm = 40.0\n"
        "[load]\ntorque_n_m = [100.0]\n"
    },
    "/v1/cases/as-made": {"inputs": {"case": CASE}, "tolerance_class": 6, "seed": 1},
    **{path: {"inputs": {"scene": SCENE}} for path in ("/v1/scenes/to-toml", "/v1/scenes/to-files")},
    "/v1/scenes/from-toml": {"toml": _SCENE_FILE},
    "/v1/scenes/housing-surface": {"housings": [MESHED_HOUSING]},
    "/v1/units/open": {"rexs_base64": b64encode(_REXS_FILE).decode()},
}
"""Other bodies, by path."""

BODIES |= {draft: BODIES[path] for draft, path in DRAFTS.items()}


def request_example(path: str) -> Json | None:
    """Return the body of a path, None if there is none."""
    parts = path.split("/")
    if parts[-1] == "execution":
        inputs = INPUTS.get(parts[-2])
        return None if inputs is None else {"inputs": inputs}
    return BODIES.get(path)
