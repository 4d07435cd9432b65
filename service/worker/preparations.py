"""Checks of a request beyond its schema, and the normalized inputs that are hashed and worked on.

Loads both libraries; the catalogue refers to these functions by name, so that a service answers before.
"""

from __future__ import annotations

from typing import Any

from fe_contact.solver_version import SOLVER_VERSION
from fe_contact.ste.facts import SCHEMA_VERSION, content_hash
from lineofaction.gearbox.convert.checks import check_case
from lineofaction.gearbox.schemas.model import BoundaryModel
from service.schemas.execute import AnalyzeInputs, SimulateInputs
from service.store import ResultStore
from service.worker.scene_inputs import check_scene_inputs

Json = dict[str, Any]


def prepare_analyze(inputs: BoundaryModel, store: ResultStore) -> Json:
    """Return the case with all defaults; check that it can be computed, unless that was done."""
    assert isinstance(inputs, AnalyzeInputs)
    normalized: Json = inputs.model_dump(mode="json")
    if store.find(name_database(normalized), "database") is None:
        check_case(inputs.case)
    return normalized


def name_database(inputs: Json) -> str:
    """Return the content hash that the database of a case will carry itself."""
    return content_hash(inputs["case"], SOLVER_VERSION, SCHEMA_VERSION)


def prepare_scene(inputs: BoundaryModel, store: ResultStore) -> Json:
    """Check the scene and the sources of its tables; return it with all defaults."""
    assert isinstance(inputs, SimulateInputs)
    check_scene_inputs(inputs.scene, store)
    return inputs.model_dump(mode="json")
