"""The work of the process analyze, done in a child process of its own."""

from __future__ import annotations

import json

from fe_contact.analysis import ste_database
from fe_contact.analysis.studies.warm_up import warm_up as load_compiled
from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from service.convert.case import analysis_options, boundary_errors, case_json, gear_pair, table_axes
from service.convert.plausibility import phrased_database
from service.schemas import Case
from service.worker.cluster import table_workers
from service.worker.drafted_progress import DraftedProgress
from service.worker.order import Product, Progress, WorkOrder


def warm_up() -> None:
    """Load what is compiled for tables."""
    load_compiled(across_face=False)


def analyze_case(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Compute the STE database of a case."""
    case = Case.model_validate_json(json.dumps(order.inputs["case"]))
    file = order.workspace / "database.nc"
    database_of(case, order, progress).to_netcdf(file)
    return (Product(order.key, "database", file),)


def database_of(case: Case, order: WorkOrder, progress: Progress) -> SteDatabase:
    """Return the STE database of a case of an order; condensed gears are kept in the service's cache."""
    drafted = DraftedProgress(progress)
    with boundary_errors(), table_workers(order) as workers:
        database = ste_database(
            gear_pair(case),
            table_axes(case),
            analysis_options(case),
            Run(workers, order.data_directory / "compliance", drafted),
            case=case_json(case),
            on_draft=drafted.draft,
        )
    return phrased_database(database, case)
