"""The processes of the service: those of studies from their rows, and others."""

from __future__ import annotations

from functools import partial

from service.registry import STUDIES, Study
from service.schemas.process_inputs import AnalyzeInputs, SimulateInputs, study_inputs
from service.stages import Stage
from service.worker.process import Process, Registry, on_demand

ANALYZE = Process(
    id="analyze",
    title="STE database of a gear pair",
    description="Contact analysis of a gear pair over positions and loads; writes an STE database.",
    version="2",
    inputs=AnalyzeInputs,
    output="database",
    kind="database",
    prepare=on_demand("service.worker.preparations:prepare_analyze"),
    entry="service.worker.analysis_work:analyze_case",
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
    stages=(Stage("analysis", 0.5), Stage("integration", 0.5)),
)


def study_process(study: Study) -> Process:
    """Return the process of a study."""
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
        stages=tuple(Stage(*stage) for stage in study.stages),
        action=study.action,
    )


def default_registry() -> Registry:
    """Return the processes every service offers."""
    studies = map(study_process, STUDIES.values())
    return Registry(ANALYZE, SIMULATE, *studies)
