"""What a request checks beyond its schema, and the normalized inputs that are hashed and worked on.

Loads both libraries; the catalogue refers to these functions by name, so that a service answers before.
"""

from __future__ import annotations

from typing import Any

from fe_contact.analysis.compute_database import SOLVER_VERSION
from fe_contact.ste.content_hash import content_hash
from fe_contact.ste.facts import SCHEMA_VERSION
from service.convert.ablation import effects_asked
from service.convert.case import case_json
from service.convert.checks import check_case
from service.convert.flanks import case_at
from service.convert.optimisation import check_optimisation_of
from service.convert.rungs import rungs_asked
from service.convert.scatter import check_scatter_of, sampling_of
from service.convert.sensitivity import Deviations, check_study
from service.jobs.scene_inputs import check_scene_inputs
from service.schemas.ablation import AblationInput
from service.schemas.case_or_scene import CaseOrScene
from service.schemas.frontier import FrontierInput
from service.schemas.model import BoundaryModel
from service.schemas.process_inputs import (
    AnalyzeInputs,
    FlankInputs,
    ModesInputs,
    OptimiseInputs,
    ResponseInputs,
    ScatterInputs,
    SensitivityInputs,
    SimulateInputs,
    SteadyInputs,
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
    assert isinstance(inputs, SimulateInputs | ModesInputs | ResponseInputs | SteadyInputs)
    check_scene_inputs(inputs.scene, store)
    return inputs.model_dump(mode="json")


def prepare_ablation(inputs: BoundaryModel, store: ResultStore) -> Json:
    """Check what is ablated; return it with all defaults and the effects in the order of their registry."""
    assert isinstance(inputs, AblationInput)
    given = _case_or_scene(inputs, store)
    return {**given, "only": effects_asked(inputs.only, of_scene="scene" in given)}


def prepare_frontier(inputs: BoundaryModel, store: ResultStore) -> Json:
    """Check what the ladder is run on; return it with all defaults and the rungs in their order."""
    assert isinstance(inputs, FrontierInput)
    given = _case_or_scene(inputs, store)
    beside = {} if inputs.full_contact is None else {"full_contact": inputs.full_contact}
    return {**given, "rungs": rungs_asked(inputs.rungs, of_scene="scene" in given), **beside}


def prepare_optimisation(inputs: BoundaryModel, _store: ResultStore) -> Json:
    """Check that everything can be varied as asked; return the inputs with all defaults."""
    assert isinstance(inputs, OptimiseInputs)
    check_optimisation_of(inputs.case, inputs)
    return inputs.model_dump(mode="json")


def prepare_scatter(inputs: BoundaryModel, _store: ResultStore) -> Json:
    """Check that the pair exists within these tolerances; return the inputs with all defaults."""
    assert isinstance(inputs, ScatterInputs)
    check_scatter_of(inputs.case, sampling_of(inputs))
    return inputs.model_dump(mode="json")


def _case_or_scene(inputs: CaseOrScene, store: ResultStore) -> Json:
    """Check the one that is given; return it with all defaults."""
    if inputs.scene is not None:
        check_scene_inputs(inputs.scene, store)
    elif inputs.case is not None:
        check_case(inputs.case)
    given = {"case"} if inputs.scene is None else {"scene"}
    return inputs.model_dump(mode="json", include=given)
