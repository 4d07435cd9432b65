"""The processes of the service: analyze, flank, sensitivity, ablate, frontier, optimise, scatter ..."""

from __future__ import annotations

from service.jobs.process import Process, Registry, Stage, on_demand
from service.schemas.ablation import AblationInput
from service.schemas.frontier import FrontierInput
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

ANALYZE = Process(
    id="analyze",
    title="STE database of a gear pair",
    description="Contact analysis of a gear pair over positions and loads; makes an STE database.",
    version="2",
    inputs=AnalyzeInputs,
    output="database",
    kind="database",
    prepare=on_demand("service.jobs.preparations:prepare_analyze"),
    entry="service.jobs.analysis_work:analyze_case",
    stages=(Stage("compliance", 0.6), Stage("contact", 0.15), Stage("error estimate", 0.25)),
    name_result=on_demand("service.jobs.preparations:name_database"),
)
FLANK = Process(
    id="flank",
    title="Flank results of a gear pair",
    description="Pressure, line load and gap on the flanks over one mesh cycle, at one load and alignment.",
    version="2",
    inputs=FlankInputs,
    output="flanks",
    kind="flanks",
    prepare=on_demand("service.jobs.preparations:prepare_flank"),
    entry="service.jobs.study_work:study_flanks",
    stages=(Stage("compliance", 0.9), Stage("contact", 0.1)),
)
SENSITIVITY = Process(
    id="sensitivity",
    title="Sensitivity to misalignment and center distance",
    description="Peak-to-peak transmission error over misalignment and center distance, varied one at a "
    "time, without and with corner contact.",
    version="2",
    inputs=SensitivityInputs,
    output="sensitivity",
    kind="sensitivity",
    prepare=on_demand("service.jobs.preparations:prepare_sensitivity"),
    entry="service.jobs.study_work:study_sensitivity_of",
    stages=(Stage("tables", 1.0),),
)
ABLATE = Process(
    id="ablate",
    title="What each effect of a case or a scene changes",
    description="Every effect toggled by itself: the change of transmission errors (and of bearing "
    "forces, for a scene), what the ledger estimated, and what it costs.",
    version="2",
    inputs=AblationInput,
    output="ablation",
    kind="ablation",
    prepare=on_demand("service.jobs.preparations:prepare_ablation"),
    entry="service.jobs.ablation_work:switch_effects",
    stages=(Stage("analysis", 0.1), Stage("ablation", 0.9)),
)
FRONTIER = Process(
    id="frontier",
    title="What accuracy costs in time on a case or a scene",
    description="The ladder of models and settings, each rung compared to the finest: error against time, "
    "the knee, and the rung that the accuracy asks for.",
    version="2",
    inputs=FrontierInput,
    output="frontier",
    kind="frontier",
    prepare=on_demand("service.jobs.preparations:prepare_frontier"),
    entry="service.jobs.frontier_work:climb_ladder",
    stages=(Stage("analysis", 0.1), Stage("ladder", 0.9)),
)
OPTIMISE = Process(
    id="optimise",
    title="Micro-geometry of least transmission error",
    description="Flank modifications of both gears for the least expected peak-to-peak transmission error "
    "over torques and scatter, with Harris maps before and after.",
    version="3",
    inputs=OptimiseInputs,
    output="optimisation",
    kind="optimisation",
    prepare=on_demand("service.jobs.preparations:prepare_optimisation"),
    entry="service.jobs.optimisation_work:optimise_flanks",
    stages=(Stage("compliance", 0.2), Stage("search", 0.6), Stage("confirmation", 0.2)),
)
SCATTER = Process(
    id="scatter",
    title="Transmission error within tolerances",
    description="Tolerance Monte Carlo: pairs drawn within a class of ISO 1328-1 and a misalignment, the "
    "distribution of their peak-to-peak transmission error with bounds, and what it depends on.",
    version="2",
    inputs=ScatterInputs,
    output="scatter",
    kind="scatter",
    prepare=on_demand("service.jobs.preparations:prepare_scatter"),
    entry="service.jobs.scatter_work:draw_pairs",
    stages=(Stage("compliance", 0.2), Stage("samples", 0.7), Stage("confirmation", 0.1)),
)
SIMULATE = Process(
    id="simulate",
    title="Dynamics of a geared system",
    description="Time integration of shafts, gears and bearings excited by STE databases; makes a run.",
    version="2",
    inputs=SimulateInputs,
    output="run",
    kind="run",
    prepare=on_demand("service.jobs.preparations:prepare_scene"),
    entry="service.jobs.simulation_work:simulate_scene",
    stages=(Stage("analysis", 0.5), Stage("integration", 0.5)),
)
MODES = Process(
    id="modes",
    title="Modes of a geared system",
    description="Natural modes about the loaded equilibrium, whirl modes over speed, and the critical speeds "
    "at which multiples of the mesh frequency meet them.",
    version="2",
    inputs=ModesInputs,
    output="modes",
    kind="modes",
    prepare=on_demand("service.jobs.preparations:prepare_scene"),
    entry="service.jobs.scene_study_work:study_modes",
    stages=(Stage("analysis", 0.9), Stage("modes", 0.1)),
)
RESPONSE = Process(
    id="response",
    title="Forced response of a geared system",
    description="Harmonic response to the static transmission errors over speed: transmission error, mesh "
    "and bearing forces by mesh order, and their peaks.",
    version="2",
    inputs=ResponseInputs,
    output="response",
    kind="response",
    prepare=on_demand("service.jobs.preparations:prepare_scene"),
    entry="service.jobs.scene_study_work:study_response",
    stages=(Stage("analysis", 0.9), Stage("response", 0.1)),
)
STEADY = Process(
    id="steady",
    title="Periodic steady states of a geared system",
    description="What a system settles on at constant speeds, rising and falling, by shooting, with Floquet "
    "stability, jumps, and the branch through its folds.",
    version="2",
    inputs=SteadyInputs,
    output="steady",
    kind="steady",
    prepare=on_demand("service.jobs.preparations:prepare_scene"),
    entry="service.jobs.scene_study_work:study_steady",
    stages=(Stage("analysis", 0.4), Stage("up", 0.2), Stage("down", 0.2), Stage("branch", 0.2)),
)


def default_registry() -> Registry:
    """Return the processes every service offers."""
    return Registry(
        ANALYZE, FLANK, SENSITIVITY, ABLATE, FRONTIER, OPTIMISE, SCATTER, SIMULATE, MODES, RESPONSE, STEADY
    )
