"""Checks of a request beyond its schema, and the normalized inputs that are hashed and worked on.

Loads both libraries; the catalogue refers to these functions by name, so that a service answers before.
"""

from __future__ import annotations

from typing import Any

from fe_contact.analysis.compute_database import SOLVER_VERSION
from fe_contact.ste.content_hash import content_hash
from fe_contact.ste.facts import SCHEMA_VERSION
from service.convert.case import case_json
from service.convert.checks import check_case
from service.convert.flanks import case_at
from service.convert.sensitivity import Deviations, check_study
from service.jobs.scene_inputs import check_scene_inputs
from service.schemas.model import BoundaryModel
from service.schemas.process_inputs import (
    AnalyzeInputs,
    FlankInputs,
    SensitivityInputs,
    SimulateInputs,
)
from service.store import ResultStore

Json = dict[str, Any]


def prepare_flank(inputs: BoundaryModel, _store: ResultStore) -> Json:
    """Check that the pair exists; return the case of this one load and alignment, with all defaults."""
    assert isinstance(inputs, FlankInputs)
    case = case_at(inputs.case, inputs)
    check_case(case, whole_table=False)
    return {"case": case_json(case)}


def prepare_sensitivity(inputs: BoundaryModel, _store: ResultStore) -> Json:
    """Check that the pair exists at every deviation; return the inputs with all defaults."""
    assert isinstance(inputs, SensitivityInputs)
    check_study(inputs.case, Deviations(inputs.misalignment_um, inputs.center_distance_change_percent))
    return inputs.model_dump(mode="json")


def prepare_analyze(inputs: BoundaryModel, _store: ResultStore) -> Json:
    """Check that the pair exists; return the case with all defaults."""
    assert isinstance(inputs, AnalyzeInputs)
    check_case(inputs.case)
    return inputs.model_dump(mode="json")


def name_database(inputs: Json) -> str:
    """Return the content hash that the database of a case will carry itself."""
    return content_hash(inputs["case"], SOLVER_VERSION, SCHEMA_VERSION)


def prepare_scene(inputs: BoundaryModel, store: ResultStore) -> Json:
    """Check the scene and the sources of its tables; return it with all defaults."""
    assert isinstance(inputs, SimulateInputs)
    check_scene_inputs(inputs.scene, store)
    return inputs.model_dump(mode="json")
