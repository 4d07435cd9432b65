"""Inputs of every process at the ends of what it takes: names of all characters, as little as can be.

They are small ones (`small_inputs`), changed by drawn extremes. Fields of a study come from its row: of a
list one entry, of a number the least that is declared, of a choice any, of a switch the other side.
"""

import math
from collections.abc import Callable
from random import Random
from typing import Any, Literal, get_args, get_origin

from annotated_types import Ge, Gt
from pydantic.fields import FieldInfo
from small_inputs import small_inputs

from dynamics.effects.registry import EFFECTS
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas.scene import OutputsInput

Json = dict[str, Any]

NAMES = (
    r"$\bad_{$",
    r"$\frac{1}{0}$",
    "$$",
    r"\$5_^",
    "</script><script>alert(1)</script>",
    "<b>&amp;&lt;",
    "%{x}<extra></extra>%s {0}",
    "[/b][red]:smile:",
    "line\nfeed\ttab\r",
    "\x1b[31m\x07\x01",
    "\u202eright to left\u2066",
    "\u05e9\u05dc\u05d5\u05dd \u0645\u0631\u062d\u0628\u0627",
    "\u9f7f\u8f6e \U0001f600 e\u0301\u0301",
    "\ufffe\uffff\u2028\u2029",
    "=1+1,'a';\"b\"",
    "../../etc",
    "a.b.c",
    " ",
    "nan",
    "x" * 60,
    "\u0416" * 60,
    "principal",
)
"""What a caller may call a part."""
LONGEST = 64


def extreme_inputs(process: str, draw: Random) -> Json:
    """Return inputs of a process, some of which it refuses; those of `listen` lack the hash of its run."""
    inputs = small_inputs(process)
    if process in STUDIES:
        for name, field in STUDIES[process].inputs.model_fields.items():
            if draw.random() < 0.4:
                inputs |= _minimum(name, field, inputs.get(name), draw)
    if "scene" in inputs:
        for extreme in draw.sample(SCENE_EXTREMES, draw.randint(0, 3)):
            extreme(inputs["scene"], draw)
    for case in _cases(inputs):
        for extreme in draw.sample(CASE_EXTREMES, draw.randint(0, 2)):
            case.update(extreme(case, draw))
    return renamed(inputs, draw) if "scene" in inputs else inputs


def renamed(inputs: Json, draw: Random) -> Json:
    """Give all parts of a scene other names, wherever they are named."""
    drawn = draw.choices(NAMES, k=99)
    parts = sorted({part["name"] for parts in inputs["scene"].values() for part in _tables(parts)})
    names = {
        old: f"{new[: LONGEST - 2]}{i or ''}" for i, (old, new) in enumerate(zip(parts, drawn, strict=False))
    }
    return _renamed(inputs, names)


def _renamed(value: Any, names: dict[str, str], key: str = "") -> Any:
    if isinstance(value, dict):
        return {name: _renamed(entry, names, name) for name, entry in value.items()}
    if isinstance(value, list):
        return [_renamed(entry, names, key) for entry in value]
    if key == "path":
        return ".".join(names.get(part, part) for part in value.split("."))
    return names.get(value, value) if isinstance(value, str) and key != "material" else value


def _tables(parts: Any) -> list[Json]:
    return (
        [part for part in parts if isinstance(part, dict) and "name" in part]
        if isinstance(parts, list)
        else []
    )


def _minimum(name: str, field: FieldInfo, value: Any, draw: Random) -> Json:
    """Return a field at an end of what it declares; nothing where it declares none."""
    own = field.get_default(call_default_factory=True) if value is None and not field.is_required() else value
    minimum = next((bound for bound in field.metadata if isinstance(bound, Ge | Gt)), None)
    if get_origin(field.annotation) is Literal:
        return {name: draw.choice(get_args(field.annotation))}
    if isinstance(own, bool):
        return {name: not own}
    if minimum is not None and own is not None:
        return {name: minimum.ge if isinstance(minimum, Ge) else 1e-6}
    if isinstance(value, list) and value:
        return {name: value[:1]}
    return {}


def _cases(inputs: Json) -> list[Json]:
    meshes = inputs.get("scene", {}).get("meshes", ())
    return [
        *(mesh["case"] for mesh in meshes if "case" in mesh),
        *(inputs[n] for n in ("case",) if n in inputs),
    ]


def _one_torque(_case: Json, draw: Random) -> Json:
    return {"load": {"torque_n_m": [draw.choice((0.5, 1e-6, 50.0))]}}


CASE_EXTREMES: tuple[Callable[[Json, Random], Json], ...] = (
    _one_torque,
    _one_torque,
    lambda _case, _draw: {"errors": {"center_distance_change_mm": [0.0, 0.02]}},
    lambda case, _draw: {"accuracy": case["accuracy"] | {"positions": 8}},
    lambda case, _draw: {"accuracy": case["accuracy"] | {"receipt": "full"}},
)
"""Fields of a case in place of its own."""


def _shortest(scene: Json, draw: Random) -> None:
    scene["run"]["duration_s"] = draw.choice((1e-6, 5e-5, 1e-3, 0.01))


def _speed(scene: Json, draw: Random) -> None:
    """Turn at one extreme speed."""
    law = draw.choice(([0.0], [1e-6], [-900.0], [30000.0]))
    scene["drives"][0] |= {"time_s": [0.0], "speed_rpm": law}


def _standing_to_fast(scene: Json, draw: Random) -> None:
    ends = draw.choice(([0.0, 1000.0], [1000.0, -1000.0]))
    scene["drives"][0] |= {"time_s": [0.0, scene["run"]["duration_s"]], "speed_rpm": ends}


def _idle(scene: Json, draw: Random) -> None:
    torque = draw.choice((0.0, 1e-9, -1.0, None))
    scene["loads"] = [load | {"torque_n_m": [torque]} for load in scene["loads"] if torque is not None]


def _outputs(scene: Json, draw: Random) -> None:
    fields = OutputsInput.model_fields.items()
    scene["outputs"] = {"sample_rate_hz": draw.choice((20000.0, 100.0, 1.0))}
    for name, field in fields:
        if draw.random() < 0.5:
            scene["outputs"] |= _minimum(name, field, None, draw)


def _effects(scene: Json, draw: Random) -> None:
    scene["effects"] = {
        name: draw.choice(("on", "off")) for name in draw.sample([effect.name for effect in EFFECTS], 2)
    }


def _spring(scene: Json, _draw: Random) -> None:
    """Let all meshes be of constant stiffness, without transmission error."""
    for mesh in scene["meshes"]:
        pair = mesh.pop("case")["pair"]
        mesh["stiffness"] = {
            "teeth": [pair[gear]["teeth"] for gear in ("pinion", "wheel")],
            "base_radius_mm": 0.5 * pair["center_distance_mm"] * math.cos(math.radians(20.0)),
            "working_pressure_angle_deg": 20.0,
            "face_width_mm": pair["pinion"]["face_width_mm"],
            "stiffness_n_per_m": {"value": [1e8]},
        }


def _no_bushings(scene: Json, _draw: Random) -> None:
    if not scene.get("housings"):
        scene["bushings"], scene["effects"] = [], {"lateral": "off", "axial": "off", "tilt": "off"}


def _rotor(scene: Json, _draw: Random) -> None:
    if not scene.get("housings"):
        scene |= {"shafts": scene["shafts"][:1], "gears": [], "meshes": [], "loads": []}
        scene["bushings"] = [bushing for bushing in scene["bushings"] if bushing["shaft"] == "input"]


SCENE_EXTREMES: tuple[Callable[[Json, Random], None], ...] = (
    _shortest,
    _speed,
    _standing_to_fast,
    _idle,
    _outputs,
    _effects,
    _spring,
    _no_bushings,
    _rotor,
)
