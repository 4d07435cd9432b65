"""The work of studies, done in a child process of its own."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from typing import Any

from service.convert.flanks import flanks_of
from service.convert.plausibility import phrased_flanks
from service.convert.sensitivity import Deviations, study_case
from service.convert.sensitivity_file import write_studies
from service.jobs.catalogue import ANALYZE
from service.jobs.cluster import cluster_of, table_workers
from service.jobs.order import Product, Progress, WorkOrder
from service.jobs.scene_inputs import check_scene_inputs
from service.jobs.simulation_work import ordered_scene
from service.registry import STUDIES, Study
from service.schemas import Case
from service.schemas.result_kinds import suffix_of
from service.store import ResultStore
from service.studies.computation import Means

Json = dict[str, Any]
Work = Callable[[WorkOrder, Progress], tuple[Product, ...]]
TABLES = 4


def study_flanks(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Compute the flank results of a case of one load and one alignment."""
    case = Case.model_validate_json(json.dumps(order.inputs["case"]))
    file = order.workspace / "flanks.nc"
    flanks = flanks_of(case, order.data_directory / "compliance", progress)
    phrased_flanks(flanks, case).to_netcdf(file)
    return (Product(order.key, "flanks", file),)


def study_sensitivity_of(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Study the sensitivity of a case."""
    case = Case.model_validate_json(json.dumps(order.inputs["case"]))
    deviations = Deviations(
        tuple(order.inputs["misalignment_um"]), tuple(order.inputs["center_distance_change_percent"])
    )
    name = f"{case.pair.pinion.teeth}/{case.pair.wheel.teeth}"
    cache = order.data_directory / "compliance"
    file = order.workspace / "sensitivity.nc"
    with table_workers(order) as workers:
        studies = [study_case(name, case, deviations, cache, table_by_table(progress), workers)]
    write_studies(studies, file)
    return (Product(order.key, "sensitivity", file),)


def table_by_table(progress: Progress) -> Progress:
    """Return what turns the progress of each of the four tables into that of the study."""
    begun = -1

    def part(stage: str, fraction: float) -> None:
        nonlocal begun
        if stage == ANALYZE.stages[0].name and fraction == 0.0:
            begun += 1
        progress("tables", (max(begun, 0) + (ANALYZE.overall(stage, fraction) or 0.0)) / TABLES)

    return part


def __getattr__(name: str) -> Work:
    """Return the work of a study by its name: so does the entry of its process."""
    if name in STUDIES:
        return partial(_work, STUDIES[name])
    raise AttributeError(name)


def prepare(study: Study, inputs: Any, store: ResultStore) -> Json:
    """Check the inputs of a study's process; return them as they are hashed and worked on."""
    name = "case" if getattr(inputs, "case", None) is not None else "scene"
    fields = study.inputs.model_fields
    subject = getattr(inputs, name)
    if name == "scene":
        check_scene_inputs(subject, store)
    varied = study.inputs.model_construct(**{field: getattr(inputs, field) for field in fields})
    study.run.check(subject, varied)
    return {name: subject.model_dump(mode="json"), **study.run.normalized(subject, varied)}


def _work(study: Study, order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Do a study, into a file."""
    subject, products, warnings = _subject(order, progress)
    varied = {name: value for name, value in order.inputs.items() if name not in ("case", "scene")}
    inputs = study.inputs.model_validate_json(json.dumps(varied))
    with cluster_of(order) as workers:
        result = study.run.compute(subject, inputs, Means(order.data_directory, progress, workers))
    file = order.workspace / f"{study.kind}{suffix_of(study.kind)}"
    study.run.save(result, file)
    return (*products, Product(order.key, study.kind, file, warnings))


def _subject(order: WorkOrder, progress: Progress) -> tuple[Any, tuple[Product, ...], Any]:
    """Return what is studied, the tables that were computed for it, and its warnings if they are known."""
    if "scene" in order.inputs:
        ordered = ordered_scene(order, progress)
        return ordered.scene, ordered.products, ordered.warnings
    return Case.model_validate_json(json.dumps(order.inputs["case"])), (), None
