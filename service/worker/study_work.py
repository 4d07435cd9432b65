"""The work of studies in a child process."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from functools import partial
from typing import Any

from dynamics.results import RunResult
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.housings import HousedScene
from lineofaction.gearbox.registry import STUDIES, SUFFIX
from lineofaction.gearbox.schemas.plan import omission_warnings
from lineofaction.gearbox.stages import PacedFraction
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.study import Study
from service.store.results import ResultStore
from service.worker.job_executor import cluster_of, table_workers
from service.worker.order import Product, Progress, WorkOrder
from service.worker.preparations import CASES, check_run, check_scene_inputs
from service.worker.simulation_work import housed_scene, ordered_scene

Json = dict[str, Any]
Work = Callable[[WorkOrder, Progress], tuple[Product, ...]]


def __getattr__(name: str) -> Work:
    """Return the work of a study as an attribute of its name: the entry of its process is this module's."""
    if name in STUDIES:
        return partial(_work, STUDIES[name])
    raise AttributeError(name)


def prepare(study: Study, inputs: Any, store: ResultStore) -> Json:
    """Check the inputs of a study's process; return them as they are hashed and worked on."""
    name = "case" if getattr(inputs, "case", None) is not None else "scene"
    fields = study.inputs.model_fields
    stated = inputs.model_fields_set & fields.keys()  # a study may tell what is left out from its default
    varied = study.inputs.model_construct(stated, **{field: getattr(inputs, field) for field in fields})
    specified = CASES.of(inputs.case) if name == "case" else inputs.scene
    subject = study.run.narrowed(specified, varied)
    if name == "scene":
        check_scene_inputs(subject, store)
    check_run(getattr(varied, "run", None), store)
    study.run.check(subject, varied)
    written = subject.case if name == "case" else subject
    return {name: written.model_dump(mode="json"), **study.run.normalized(subject, varied)}


def _work(study: Study, order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    subject, products, warnings = _subject(study, order, progress)
    varied = {name: value for name, value in order.inputs.items() if name not in ("case", "scene")}
    inputs = study.inputs.model_validate_json(json.dumps(varied))
    executor = table_workers if study.run.resumed else cluster_of
    with executor(order) as workers:
        key = getattr(inputs, "run", None)
        run = None if key is None else RunResult.from_netcdf(order.stored[key])
        report = _paced(study, subject, inputs, order, progress)
        means = Means(order.data_directory, report, workers, folder=order.workspace / "runs", run=run)
        result = study.run.compute(subject, inputs, means)
    file = order.workspace / f"{study.kind}{SUFFIX}"
    study.run.file.write(result, file)
    result_warnings = study.run.warnings(result) if warnings is None else warnings
    if isinstance(subject, HousedScene):
        result_warnings = [*omission_warnings(subject.inputs.left_out), *(result_warnings or ())]
    runs = (Product(key, "run", run) for key, run in study.run.stored_runs(result, means).items())
    return (*products, *runs, Product(order.key, study.kind, file, result_warnings))


def _paced(study: Study, subject: Any, inputs: Any, order: WorkOrder, progress: Progress) -> Progress:
    """Return the progress of a study of a case with the fraction of the whole, by its planned cost.

    The plan of a scene needs steps of its motion: its stages have their usual shares, at the other end.
    """
    if not isinstance(subject, CheckedCase):
        return progress
    cost = study.run.predicted(subject, inputs, order.data_directory / "compliance")
    if cost is None:
        return progress
    paced, begun_s = PacedFraction(cost.shares(study.stages)), time.monotonic()

    def report(stage: str, fraction: float, _whole: float | None = None) -> None:
        progress(stage, fraction, paced.at(stage, fraction, time.monotonic() - begun_s))

    return report


def _subject(study: Study, order: WorkOrder, progress: Progress) -> tuple[Any, tuple[Product, ...], Any]:
    """Return the subject of a study, the tables computed for it, and its warnings if known."""
    if not study.run.tables:
        return housed_scene(order, progress), (), None
    if "scene" in order.inputs:
        ordered = ordered_scene(order, progress)
        return ordered.tabled, ordered.products, ordered.warnings
    return CASES.of_json(order.inputs["case"]), (), None
