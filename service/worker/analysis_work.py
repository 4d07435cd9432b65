"""The work of the process analyze, done in a child process of its own."""

from __future__ import annotations

import json
from pathlib import Path
from tempfile import TemporaryDirectory

from fe_contact.analysis import ste_database
from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.case import (
    analysis_options,
    boundary_errors,
    case_json,
    gear_pair,
    table_axes,
)
from lineofaction.gearbox.convert.plausibility import phrased_database
from lineofaction.gearbox.schemas import Case, validated
from service.worker.cluster import table_workers
from service.worker.drafted_progress import DraftedProgress
from service.worker.order import Product, Progress, WorkOrder


def warm_up() -> None:
    """Analyze the smallest pair into a file: it loads what every analysis needs."""
    gear = {"teeth": 20, "face_width_mm": 2.0, "bore_diameter_mm": 10.0}
    pair = {"normal_module_mm": 1.0, "center_distance_mm": 20.0, "pinion": gear, "wheel": gear}
    accuracy = {"level": "draft", "positions": 8}
    case = {"pair": pair, "load": {"torque_n_m": [0.1]}, "accuracy": accuracy}
    with TemporaryDirectory() as name:
        inputs = {"case": validated(Case, case).model_dump(mode="json")}
        analyze_case(WorkOrder("", inputs, "", Path(name), Path(name)), lambda *_: None)


def analyze_case(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Compute the STE database of a case."""
    case = Case.model_validate_json(json.dumps(order.inputs["case"]))
    file = order.workspace / "database.nc"
    database_of(case, order, progress).to_netcdf(file)
    return (Product(order.key, "database", file),)


def database_of(case: Case, order: WorkOrder, progress: Progress) -> SteDatabase:
    """Return the STE database of a case of an order; condensed gears are kept in the service's cache."""
    drafted = DraftedProgress(progress, refines=case.accuracy.tolerance is not None)
    with boundary_errors(), table_workers(order) as workers:
        database = ste_database(
            gear_pair(case),
            table_axes(case),
            analysis_options(case),
            Run(workers, order.data_directory / "compliance", drafted, drafted.plan),
            case=case_json(case),
            on_draft=drafted.draft,
        )
    return phrased_database(database, case)
