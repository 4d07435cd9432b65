"""Bodies that start from feasible pairs and differ from the examples of the API in a few fields."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

from feasible_pairs import cases
from hypothesis import strategies as st
from plausible_values import Fields
from toml_text import toml_text

from service.schemas.examples import request_example

Json = dict[str, Any]

JSON = "application/json"
MOST_CHANGES = 2


class FeasibleBodies:
    """The bodies of the operations of a document; `examples` by path are in place of the document's."""

    def __init__(self, document: Mapping[str, Any], examples: Mapping[str, Json]) -> None:
        self._paths = document["paths"]
        self._fields = Fields(document)
        self._examples = examples

    def of(self, path: str, method: str) -> st.SearchStrategy[Json] | None:
        """Return the bodies of an operation; None where they are more than JSON, or have no example."""
        content = self._paths[path][method]["requestBody"]["content"]
        example = self._examples.get(path) or request_example(path)
        if list(content) != [JSON] or example is None:
            return None
        schema = content[JSON]["schema"]
        bodies = cases().map(lambda case: about(example, case))
        return bodies.flatmap(lambda body: self._fields.varied(body, schema, MOST_CHANGES))


def about(example: Json, case: Json) -> Json:
    body = copy.deepcopy(example)
    inputs = body.get("inputs", {})
    if "case" in inputs:
        inputs["case"] = case
        inputs.pop("variables", None)  # their lengths are those of another module
    if "scene" in inputs:
        _put_in(inputs["scene"], case)
    if "toml" in body and "shafts" not in body["toml"]:
        body["toml"] = toml_text(case)
    return body


def _put_in(scene: Json, case: Json) -> None:
    pair = case["pair"]
    scene["meshes"][0]["case"] = case
    distance = -pair["center_distance_mm"] if pair["wheel"].get("internal") else pair["center_distance_mm"]
    scene["shafts"][1]["origin_mm"] = [distance, 0.0, 0.0]
    for gear, name in zip(scene["gears"], ("pinion", "wheel"), strict=True):
        gear["bore_diameter_mm"] = pair[name].get("bore_diameter_mm", 0.0)
