"""The processes of the service: analyze, flank, sensitivity, ablate, frontier, simulate, scene studies."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from fe_contact.analysis.compute_database import SOLVER_VERSION
from fe_contact.ste.content_hash import content_hash
from fe_contact.ste.facts import SCHEMA_VERSION
from service.convert.ablation import effects_asked
from service.convert.case import case_json
from service.convert.checks import check_case
from service.convert.flanks import case_at
from service.convert.rungs import rungs_asked
from service.convert.sensitivity import Deviations, check_study
from service.jobs.process import Process, Registry, Stage
from service.jobs.scene_inputs import check_scene_inputs
from service.schemas import Case
from service.schemas.ablation import AblationInput
from service.schemas.case_or_scene import CaseOrScene
from service.schemas.dynamic_studies import ModesInput, ResponseInput, SteadyInput
from service.schemas.flank import FlankPoint
from service.schemas.frontier import FrontierInput
from service.schemas.model import BoundaryModel
from service.schemas.scene import SceneInput
from service.schemas.sensitivity import DeviationsInput
from service.store import ResultStore

Json = dict[str, Any]


class AnalyzeInputs(BoundaryModel):
    """Inputs of the process analyze."""

    case: Case = Field(description="The case, as in a case file")


class SimulateInputs(BoundaryModel):
    """Inputs of the process simulate."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


class ModesInputs(ModesInput):
    """Inputs of the process modes."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


class ResponseInputs(ResponseInput):
    """Inputs of the process response."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


class SteadyInputs(SteadyInput):
    """Inputs of the process steady."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


class FlankInputs(FlankPoint):
    """Inputs of the process flank."""

    case: Case = Field(description="The case, as in a case file")


class SensitivityInputs(DeviationsInput):
    """Inputs of the process sensitivity."""

    case: Case = Field(description="The case, as in a case file; its highest load counts")


def _prepare_flank(inputs: BoundaryModel, _store: ResultStore) -> Json:
    """Check that the pair exists; return the case of this one load and alignment, with all defaults."""
    assert isinstance(inputs, FlankInputs)
    case = case_at(inputs.case, inputs)
    check_case(case, whole_table=False)
    return {"case": case_json(case)}


def _prepare_sensitivity(inputs: BoundaryModel, _store: ResultStore) -> Json:
    """Check that the pair exists at every deviation; return the inputs with all defaults."""
    assert isinstance(inputs, SensitivityInputs)
    check_study(inputs.case, Deviations(inputs.misalignment_um, inputs.center_distance_change_percent))
    return inputs.model_dump(mode="json")


def _prepare_analyze(inputs: BoundaryModel, _store: ResultStore) -> Json:
    """Check that the pair exists; return the case with all defaults."""
    assert isinstance(inputs, AnalyzeInputs)
    check_case(inputs.case)
    return inputs.model_dump(mode="json")


def _name_database(inputs: Json) -> str:
    """Return the content hash that the database of a case will carry itself."""
    return content_hash(inputs["case"], SOLVER_VERSION, SCHEMA_VERSION)


def _prepare_scene(inputs: BoundaryModel, store: ResultStore) -> Json:
    """Check the scene and the sources of its tables; return it with all defaults."""
    assert isinstance(inputs, SimulateInputs | ModesInputs | ResponseInputs | SteadyInputs)
    check_scene_inputs(inputs.scene, store)
    return inputs.model_dump(mode="json")


def _prepare_ablation(inputs: BoundaryModel, store: ResultStore) -> Json:
    """Check what is ablated; return it with all defaults and the effects in the order of their registry."""
    assert isinstance(inputs, AblationInput)
    given = _case_or_scene(inputs, store)
    return {**given, "only": effects_asked(inputs.only, of_scene="scene" in given)}


def _prepare_frontier(inputs: BoundaryModel, store: ResultStore) -> Json:
    """Check what the ladder is run on; return it with all defaults and the rungs in their order."""
    assert isinstance(inputs, FrontierInput)
    given = _case_or_scene(inputs, store)
    return {**given, "rungs": rungs_asked(inputs.rungs, of_scene="scene" in given)}


def _case_or_scene(inputs: CaseOrScene, store: ResultStore) -> Json:
    """Check the one that is given; return it with all defaults."""
    if inputs.scene is not None:
        check_scene_inputs(inputs.scene, store)
    elif inputs.case is not None:
        check_case(inputs.case)
    given = {"case"} if inputs.scene is None else {"scene"}
    return inputs.model_dump(mode="json", include=given)


ANALYZE = Process(
    id="analyze",
    title="STE database of a gear pair",
    description="Contact analysis of a gear pair over positions and loads; makes an STE database.",
    version="1",
    inputs=AnalyzeInputs,
    output="database",
    kind="database",
    prepare=_prepare_analyze,
    entry="service.jobs.analysis_work:analyze_case",
    stages=(Stage("compliance", 0.6), Stage("contact", 0.15), Stage("error estimate", 0.25)),
    name_result=_name_database,
)
FLANK = Process(
    id="flank",
    title="Flank results of a gear pair",
    description="Pressure, line load and gap on the flanks over one mesh cycle, at one load and alignment.",
    version="1",
    inputs=FlankInputs,
    output="flanks",
    kind="flanks",
    prepare=_prepare_flank,
    entry="service.jobs.study_work:study_flanks",
    stages=(Stage("compliance", 0.9), Stage("contact", 0.1)),
)
SENSITIVITY = Process(
    id="sensitivity",
    title="Sensitivity to misalignment and centre distance",
    description="Peak-to-peak transmission error over misalignment and centre distance, varied one at a "
    "time, without and with corner contact.",
    version="1",
    inputs=SensitivityInputs,
    output="sensitivity",
    kind="sensitivity",
    prepare=_prepare_sensitivity,
    entry="service.jobs.study_work:study_sensitivity_of",
    stages=(Stage("tables", 1.0),),
)
ABLATE = Process(
    id="ablate",
    title="What each effect of a case or a scene changes",
    description="Every effect switched over by itself: the change of transmission errors (and of bearing "
    "forces, for a scene), what the ledger estimated, and what it costs.",
    version="1",
    inputs=AblationInput,
    output="ablation",
    kind="ablation",
    prepare=_prepare_ablation,
    entry="service.jobs.ablation_work:switch_effects",
    stages=(Stage("analysis", 0.1), Stage("ablation", 0.9)),
)
FRONTIER = Process(
    id="frontier",
    title="What accuracy costs in time on a case or a scene",
    description="The ladder of models and settings, each rung compared to the finest: error against time, "
    "the knee, and the rung that the accuracy asks for.",
    version="1",
    inputs=FrontierInput,
    output="frontier",
    kind="frontier",
    prepare=_prepare_frontier,
    entry="service.jobs.frontier_work:climb_ladder",
    stages=(Stage("analysis", 0.1), Stage("ladder", 0.9)),
)
SIMULATE = Process(
    id="simulate",
    title="Dynamics of a geared system",
    description="Time integration of shafts, gears and bearings excited by STE databases; makes a run.",
    version="1",
    inputs=SimulateInputs,
    output="run",
    kind="run",
    prepare=_prepare_scene,
    entry="service.jobs.simulation_work:simulate_scene",
    stages=(Stage("analysis", 0.5), Stage("integration", 0.5)),
)
MODES = Process(
    id="modes",
    title="Modes of a geared system",
    description="Natural modes about the loaded equilibrium, whirl modes over speed, and the critical speeds "
    "at which multiples of the mesh frequency meet them.",
    version="1",
    inputs=ModesInputs,
    output="modes",
    kind="modes",
    prepare=_prepare_scene,
    entry="service.jobs.scene_study_work:study_modes",
    stages=(Stage("analysis", 0.9), Stage("modes", 0.1)),
)
RESPONSE = Process(
    id="response",
    title="Forced response of a geared system",
    description="Harmonic response to the static transmission errors over speed: transmission error, mesh "
    "and bearing forces by mesh order, and their peaks.",
    version="1",
    inputs=ResponseInputs,
    output="response",
    kind="response",
    prepare=_prepare_scene,
    entry="service.jobs.scene_study_work:study_response",
    stages=(Stage("analysis", 0.9), Stage("response", 0.1)),
)
STEADY = Process(
    id="steady",
    title="Periodic steady states of a geared system",
    description="What a system settles on at constant speeds, rising and falling, by shooting, with Floquet "
    "stability, jumps, and the branch through its folds.",
    version="1",
    inputs=SteadyInputs,
    output="steady",
    kind="steady",
    prepare=_prepare_scene,
    entry="service.jobs.scene_study_work:study_steady",
    stages=(Stage("analysis", 0.4), Stage("up", 0.2), Stage("down", 0.2), Stage("branch", 0.2)),
)


def default_registry() -> Registry:
    """Return the processes every service offers."""
    return Registry(ANALYZE, FLANK, SENSITIVITY, ABLATE, FRONTIER, SIMULATE, MODES, RESPONSE, STEADY)
