"""Scenes that cannot move, with the field at fault: in SI for Python, as a scene file elsewhere."""

import copy
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from planetary_scenes import driven_scene, published_set
from repository import EXAMPLES

from dynamics import Coupling, ImposedRotation, LoadTorque, Scene, TimeLaw, simulate

Table = dict[str, Any]


def good_scene() -> Table:
    """Return the planetary example with its cases written out."""
    table = tomllib.loads((EXAMPLES / "planetary_scene.toml").read_text())
    for mesh in table["meshes"]:
        mesh["case"] = tomllib.loads((EXAMPLES / mesh.pop("case_file")).read_text())
    return table


@dataclass(frozen=True)
class BadScene:
    """One scene: how Python makes it and what it names, what is wrong in the file and the field there."""

    name: str
    python: Callable[[], object]
    python_field: str
    change: Callable[[Table], object]
    field: str
    subject = "scene"
    process = "simulate"

    def table(self) -> Table:
        table = copy.deepcopy(good_scene())
        self.change(table)
        return table


def run(**changes: Any) -> object:
    return simulate(replace(driven_scene(published_set(3)), **changes))


def drives(**speed: float) -> tuple[ImposedRotation, ...]:
    return tuple(ImposedRotation(name, name, TimeLaw.constant(value)) for name, value in speed.items())


def load(shaft: str, torque: float) -> tuple[LoadTorque, ...]:
    return (LoadTorque("brake", shaft, TimeLaw.constant(torque)),)


def fixed_sun() -> object:
    """Run the set with its sun described in the fixed frame."""
    scene: Scene = driven_scene(published_set(3))
    shafts = tuple(replace(s, frame=None) if s.name == "sun" else s for s in scene.shafts)
    return simulate(replace(scene, shafts=shafts))


JOINT = {"name": "joint", "first": "sun", "second": "carrier", "torsional_stiffness_n_m_per_rad": 1e5}

BAD_SCENES: tuple[BadScene, ...] = (
    BadScene(
        "one drive too many",
        lambda: run(drives=drives(sun=100.0, ring=0.0, carrier=10.0)),
        "drives[2].shaft",
        lambda t: t["drives"].append({"name": "third", "shaft": "carrier", "speed_rpm": [10.0]}),
        "drives[2].shaft",
    ),
    BadScene(
        "one drive too few",
        lambda: run(drives=drives(sun=100.0)),
        "shafts[1]",
        lambda t: t["drives"].pop(),
        "shafts[0]",
    ),
    BadScene(
        "load on a held shaft",
        lambda: run(loads=load("ring", 100.0)),
        "loads[0].shaft",
        lambda t: t["loads"][0].update(shaft="ring"),
        "loads[0].shaft",
    ),
    BadScene(
        "load that drives",
        lambda: run(loads=load("carrier", -100.0)),
        "meshes[0]",
        lambda t: t["loads"][0].update(torque_n_m=[-100.0]),
        "meshes[0]",
    ),
    BadScene(
        "coupling that locks the set",
        lambda: run(couplings=(Coupling("joint", "sun", "carrier", 1e5),)),
        "drives[1].shaft",
        lambda t: t.update(couplings=[JOINT]),
        "drives[1].shaft",
    ),
    BadScene(
        "planets that do not fit",
        lambda: published_set(5, teeth=(27, 36, 99)),
        "planets",
        lambda t: t["planets"][0].update(number=7, tangential_errors_um=[0.0] * 7),
        "planets[0].number",
    ),
    BadScene(
        "set that turns as one",
        lambda: run(drives=drives(sun=100.0, ring=100.0)),
        "meshes[0].driver",
        lambda t: t.update(
            drives=[{"name": name, "shaft": name, "speed_rpm": [100.0]} for name in ("sun", "ring")]
        ),
        "meshes[0].driver",
    ),
    BadScene(
        "mesh across frames",
        fixed_sun,
        "meshes[0].driven",
        lambda t: t["shafts"][1].pop("frame"),
        "meshes[0].driven",
    ),
)
