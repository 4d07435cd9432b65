"""The text of a case or scene file, read as routes answer it; by a worker if the text is long."""

from __future__ import annotations

from typing import Any

from service.convert.case import case_json
from service.schemas import Case
from service.schemas.reading import validated
from service.schemas.scene import SceneInput
from service.schemas.toml_table import toml_table

Json = dict[str, Any]


def case_of_toml(inputs: Json) -> Json:
    """Return the case in a text with all defaults; raises `BadInput`."""
    return {"case": case_json(validated(Case, toml_table(inputs["toml"], "toml")))}


def scene_of_toml(inputs: Json) -> Json:
    """Return the scene in a text as it was written, without defaults; raises `BadInput`."""
    scene = validated(SceneInput, toml_table(inputs["toml"], "toml"))
    return {"scene": scene.model_dump(mode="json", exclude_unset=True)}
