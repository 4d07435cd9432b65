"""The work of the service's processes analyze and simulate, done in a child process.

An order is one computation with its inputs; its workspace is a directory of its own, in which another attempt
finds the files of a worker that died. A product is a file that the work made for the store. A table is an STE
database. It is refined in passes until its tolerance is met; a draft is the table after a pass.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from dynamics.errors import ResultError
from dynamics.scene import Scene
from dynamics.simulation import simulate_to_file
from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from host.optional_modules import load_numerics
from lineofaction.gearbox.convert.answers import draft_line, headline_json
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.housings import HousedScene, reduced_in
from lineofaction.gearbox.convert.measured_housings import read_responses
from lineofaction.gearbox.convert.plausibility import scene_warnings
from lineofaction.gearbox.convert.scene import TabledScene, dynamic_scene
from lineofaction.gearbox.level_quantity import with_quantity
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.result_files import stamp_scene
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.stages import staged
from lineofaction.gearbox.studies.excitations import scene_metadata
from lineofaction.gearbox.tabled_scene import checked_table
from model_studies.progress import Report, TableFraction, by_cost
from service.worker.job_executor import table_workers
from service.worker.order import Product, Progress, WorkOrder
from service.worker.preparations import CASES, name_of_table


class DraftedProgress:
    """Reports the progress of a table: the stage and its fraction done, and the fraction of the whole table.

    The figures of the last draft are written behind the name of the stage. A table that `refines` may have
    passes after the first.
    """

    def __init__(self, report: Progress, *, refines: bool) -> None:
        self._report = report
        self._draft = ""  # figures of the last draft; empty before there is one
        self._table = TableFraction(refines=refines)

    def __call__(self, stage: str, fraction: float) -> None:
        """Report the completed fraction of a stage, with the fraction of the whole table."""
        name = f"{stage}; {self._draft}" if self._draft else stage
        self._report(name, fraction, self._table.at(stage, fraction))

    def plan(self, stages: Mapping[str, float]) -> None:
        """Set the predicted cost of the stages of a pass that begins."""
        self._table.plan(stages)

    def draft(self, table: SteDatabase, refining: str) -> None:
        """Set the draft to the figures of a table that is being refined."""
        self._draft = draft_line(table, refining)


def warm_up() -> None:
    """Analyze the smallest pair into a temporary file, so that all that an analysis needs is loaded."""
    load_numerics()
    gear = {"teeth": 20, "face_width_mm": 2.0, "bore_diameter_mm": 10.0}
    pair = {"normal_module_mm": 1.0, "center_distance_mm": 20.0, "pinion": gear, "wheel": gear}
    accuracy = {"level": "draft", "positions": 8}
    case = {"pair": pair, "load": {"torque_n_m": [0.1]}, "accuracy": accuracy}
    with TemporaryDirectory() as name:
        inputs = {"case": validated(Case, case).model_dump(mode="json")}
        order = WorkOrder(
            entry="", inputs=inputs, key="", workspace=Path(name), data_directory=Path(name)
        )  # no entry or key: nobody dispatches the order or stores its product
        analyze_case(order, lambda *_: None)


def analyze_case(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Compute the STE database of a case; the product is its file."""
    case = CASES.of_json(order.inputs["case"])
    file = order.workspace / "database.nc"
    database = database_of(case, order, progress)
    database.to_netcdf(file)
    return (_product(order.key, database, file),)


def _product(key: str, database: SteDatabase, file: Path) -> Product:
    """Return the product of a database that was written to `file`."""
    return Product(key, "database", file, headline=headline_json(database))


def database_of(case: CheckedCase, order: WorkOrder, progress: Progress) -> SteDatabase:
    """Compute the STE database of a case; the service's cache keeps the compliances of its gears."""
    drafted = DraftedProgress(progress, refines=case.case.accuracy.tolerance is not None)
    with boundary_errors(), table_workers(order) as workers:
        run = Run(workers, order.data_directory / "compliance", drafted, drafted.plan)
        return checked_table(case, run, drafted.draft)


def simulate_scene(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Simulate a scene; missing tables are computed, and stored as products of the job."""
    ordered = ordered_scene(order, progress)
    file = order.workspace / "run.nc"
    _run(ordered.tabled.scene, file, progress)
    stamp_scene(file, scene_metadata(ordered.tabled))
    return (*ordered.products, Product(order.key, "run", file, ordered.warnings))


@dataclass(frozen=True)
class _OrderedScene:
    """The scene of an order with its tables; `products` are the tables that had to be computed."""

    tabled: TabledScene
    products: tuple[Product, ...]
    warnings: list[dict[str, Any]]


def ordered_scene(order: WorkOrder, progress: Progress) -> _OrderedScene:
    """Return the scene of an order: its housings are reduced, its tables read from the store or computed."""
    housed = housed_scene(order, progress)
    inputs, housings = housed.inputs, housed.housings
    products: list[Product] = []
    databases: dict[str, SteDatabase] = {}
    # A table in the store costs nothing; those to be computed count alike.
    costs = {mesh.name: float(_stored_key(order, mesh) is None) for _, mesh in inputs.with_database}
    tables = by_cost(partial(progress, "analysis"), costs)
    for index, mesh in inputs.with_database:
        databases[mesh.name] = _table(order, index, mesh, products, partial(tables, mesh.name))
    scene = with_quantity(dynamic_scene(inputs, databases, housings), inputs, housings)
    warnings = {name: database.metadata.warnings for name, database in databases.items()}
    tabled = TabledScene(inputs, databases, scene, housings)
    return _OrderedScene(tabled, tuple(products), scene_warnings(inputs, scene, warnings))


def housed_scene(order: WorkOrder, progress: Progress) -> HousedScene:
    """Return the scene of an order with its housings reduced, measured responses of housings read first."""
    inputs = SceneInput.model_validate_json(json.dumps(order.inputs["scene"]))
    read_responses(inputs)
    return HousedScene(inputs, reduced_in(inputs, order.data_directory, progress))


def _stored_key(order: WorkOrder, mesh: MeshInput) -> str | None:
    """Return the key of the stored database of a mesh, None if the database has to be computed."""
    key = name_of_table(mesh)
    return key if key in order.stored else None


def _run(scene: Scene, file: Path, progress: Progress) -> None:
    """Simulate a scene into a file; go on from where the worker of an earlier attempt died.

    A file that cannot be resumed is written anew.
    """
    try:
        status = simulate_to_file(scene, file, resume=True, progress=staged(progress))
    except ResultError:
        status = simulate_to_file(scene, file, progress=staged(progress))
    if not status.usable:
        raise JobFailed(f"The run ended early: {status.name.lower().replace('_', ' ')}.")


def _table(
    order: WorkOrder, index: int, mesh: MeshInput, products: list[Product], report: Report
) -> SteDatabase:
    """Return the database of a mesh, read from the store or computed; a computed one joins `products`."""
    stored_key = _stored_key(order, mesh)
    if stored_key is not None:
        return SteDatabase.from_netcdf(order.stored[stored_key])
    assert mesh.case is not None
    key = name_of_table(mesh)
    file = order.workspace / f"database_{index}.nc"
    if file.is_file():  # written by a worker that died later
        database = SteDatabase.from_netcdf(file)
        products.append(_product(key, database, file))
        return database

    def report_total(_stage: str, _fraction: float, total: float | None = None, /) -> None:
        report(total or 0.0)  # the scene's progress has no stages of a table

    try:
        database = database_of(CASES.of(mesh.case), order, report_total)
    except BadInput as error:
        raise error.within(f"meshes[{index}].case") from None
    database.to_netcdf(file)
    products.append(_product(key, database, file))
    return database
