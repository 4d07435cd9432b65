"""The wind-turbine example on a small table, with the facts of its own pairs."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from small_table import small_table

from dynamics.scene import Scene
from fe_contact.ste import PairFacts
from lineofaction.gearbox.convert.case import check_case
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput

EXAMPLES = Path(__file__).parents[2] / "examples"
Change = Callable[[dict[str, Any]], object]


def wind_turbine(change: Change = lambda _table: None) -> Scene:
    """Return the scene, its deflections those of spur gears 20/20 at the normal force of each mesh.

    Loads are beyond the small table, so that runs only report it: torques hold whatever the tables.
    """
    table = tomllib.loads((EXAMPLES / "wind_turbine_scene.toml").read_text(encoding="utf-8"))
    table["run"]["on_violation"] = "report"
    change(table)
    small = small_table()
    fields = {name: getattr(small, name) for name in small.__dataclass_fields__}
    databases = {}
    for mesh in table["meshes"]:
        facts = PairFacts.of(check_case(read_model(Case, EXAMPLES / mesh["case_file"])))
        torque = small.force * math.cos(facts.base_helix_angle) * facts.base_radius[0]
        databases[mesh["name"]] = type(small)(**fields | {"facts": facts, "torque": torque})
    return dynamic_scene(validated(SceneInput, table), databases)
