"""A process that can be run, and the registry of all processes, of studies and others."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NoReturn

import rfc8785

from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import NoSuchProcess
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.stages import Stage
from lineofaction.gearbox.study import Study
from service.schemas.execute import AnalyzeInputs, SimulateInputs, study_inputs
from service.version import solver_version

if TYPE_CHECKING:
    from service.store.results import ResultStore


Json = dict[str, Any]
Prepare = Callable[[BoundaryModel, "ResultStore"], Json]
_HOUSING = Stage("housing", 0.3)
"""Stage of the mesh and modes of solids; it gets no share in a scene without solids."""


def content_key(process: str, process_version: str, inputs: dict[str, Any]) -> str:
    """Return the SHA-256 of the RFC 8785 form of the normalized inputs and the versions, hexadecimal."""
    content: dict[str, Any] = {
        "process": process,
        "process_version": process_version,
        "solver_version": solver_version(),
        "inputs": inputs,
    }
    return hashlib.sha256(rfc8785.dumps(content)).hexdigest()


@dataclass(frozen=True)
class Process:
    """A kind of job; `id` to `inputs` are as in OGC API - Processes."""

    id: str
    title: str
    description: str
    version: str
    inputs: type[BoundaryModel]
    output: str
    """Name of the one output, which is the kind of its result."""
    kind: str
    """Kind of the result in the store."""
    prepare: Prepare
    """Checks what a schema cannot (raises `BadInput`), and returns the normalized inputs, which are hashed,
    stored and worked on. It runs in the request, so it is cheap."""
    entry: str
    """Work as ``"module:function"``, called as ``function(order, progress)`` in a process of its own."""
    stages: tuple[Stage, ...]
    """Stages that the work reports, in order; empty where the work predicts their cost itself."""
    action: str = ""
    """Label of a button; empty: the process is no study."""
    plan: str = ""
    """Function of the live worker that predicts the cost, as `entry`; empty: none does."""
    name_result: Callable[[Json], str] | None = None
    """Returns the content hash of the result of normalized inputs; None: `content_key` does."""

    def key(self, inputs: Json) -> str:
        """Return the content hash of the result of normalized inputs."""
        if self.name_result is not None:
            return self.name_result(inputs)
        return content_key(self.id, self.version, inputs)


class Registry(dict[str, Process]):
    """The processes of a service, by id; a lookup of another name raises `NoSuchProcess`."""

    def __init__(self, *processes: Process) -> None:
        super().__init__({process.id: process for process in processes})

    def __missing__(self, name: str) -> NoReturn:
        raise NoSuchProcess(f"There is no process {name!r}. Known: {', '.join(self)}.")

    @property
    def modules(self) -> frozenset[str]:
        """Names of the modules that hold the entries."""
        return frozenset(process.entry.partition(":")[0] for process in self.values())


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
    version="4",
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
        stages=stages if study.takes.subject == "case" else _of_scene(*stages),
        action=study.action,
    )


def default_registry() -> Registry:
    """Return the processes every service offers."""
    studies = map(_study_process, STUDIES.values())
    return Registry(ANALYZE, SIMULATE, *studies)
