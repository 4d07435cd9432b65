"""The processes of the service: those of studies from their rows, and others."""

from __future__ import annotations

from functools import partial

from lineofaction.gearbox.registry import STUDIES, Study
from lineofaction.gearbox.stages import Stage
from service.schemas.execute import AnalyzeInputs, SimulateInputs, study_inputs
from service.worker.process import Process, Registry, on_demand

_HOUSING = Stage("housing", 0.3)
"""Mesh and modes of solids; a stage that a scene does without has no share."""


def _of_scene(*stages: Stage) -> tuple[Stage, ...]:
    return (_HOUSING, *(Stage(stage.name, (1.0 - _HOUSING.share) * stage.share) for stage in stages))


ANALYZE = Process(
    id="analyze",
    title="STE database of a gear pair",
    description="Contact analysis of a gear pair over positions and loads; writes an STE database.",
    version="2",
    inputs=AnalyzeInputs,
    output="database",
    kind="database",
    prepare=on_demand("service.worker.preparations:prepare_analyze"),
    entry="service.worker.simulation_work:analyze_case",
    stages=(),
    plan="service.live.work:live_plan",
    name_result=on_demand("service.worker.preparations:name_database"),
)
SIMULATE = Process(
    id="simulate",
    title="Dynamics of a geared system",
    description="Time integration of shafts, gears and bearings excited by STE databases; writes a run.",
    version="2",
    inputs=SimulateInputs,
    output="run",
    kind="run",
    prepare=on_demand("service.worker.preparations:prepare_scene"),
    entry="service.worker.simulation_work:simulate_scene",
    stages=_of_scene(Stage("analysis", 0.5), Stage("integration", 0.5)),
)


def _study_process(study: Study) -> Process:
    stages = tuple(Stage(*stage) for stage in study.stages)
    return Process(
        id=study.name,
        title=study.title,
        description=study.description,
        version=study.version,
        inputs=study_inputs(study),
        output=study.kind,
        kind=study.kind,
        prepare=partial(on_demand("service.worker.study_work:prepare"), study),
        entry=f"service.worker.study_work:{study.name}",
        stages=stages if study.subject == "case" else _of_scene(*stages),
        action=study.action,
    )


def default_registry() -> Registry:
    """Return the processes every service offers."""
    studies = map(_study_process, STUDIES.values())
    return Registry(ANALYZE, SIMULATE, *studies)
