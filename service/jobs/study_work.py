"""The work of the processes flank and sensitivity, done in a child process of its own."""

from __future__ import annotations

import json

from service.convert.flanks import flanks_of
from service.convert.plausibility import phrased_flanks
from service.convert.sensitivity import Deviations, study_case
from service.convert.sensitivity_file import write_studies
from service.jobs.catalogue import ANALYZE
from service.jobs.cluster import table_workers
from service.jobs.order import Product, Progress, WorkOrder
from service.schemas import Case

TABLES = 4


def study_flanks(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Compute the flank results of a case of one load and one alignment."""
    case = Case.model_validate_json(json.dumps(order.inputs["case"]))
    file = order.workspace / "flanks.nc"
    found = flanks_of(case, order.data_directory / "compliance", progress)
    phrased_flanks(found, case).to_netcdf(file)
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
