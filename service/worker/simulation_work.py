"""The work of the processes analyze and simulate, done in a child process of its own."""

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
from lineofaction.gearbox.convert.answers import draft_line, headline_json
from lineofaction.gearbox.convert.case import boundary_errors
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
from lineofaction.gearbox.stages import TableFraction, staged
from lineofaction.gearbox.studies.excitations import scene_metadata
from lineofaction.gearbox.tabled_scene import checked_table
from model_studies.progress import Report, by_cost
from service.worker.job_executor import table_workers
from service.worker.order import Product, Progress, WorkOrder
from service.worker.preparations import CASES, name_of_table


class DraftedProgress:
    """Reports stages, with the last draft behind their names, and the fraction of the whole table.

    It reports (stage, fraction, whole); a table that `refines` may have passes after the first.
    """

    def __init__(self, report: Progress, *, refines: bool) -> None:
        self._report, self._draft = report, ""
        self._table = TableFraction(refines=refines)

    def __call__(self, stage: str, fraction: float) -> None:
        """Report the fraction done of a stage."""
        name = f"{stage}; {self._draft}" if self._draft else stage
        self._report(name, fraction, self._table.at(stage, fraction))

    def plan(self, stages: Mapping[str, float]) -> None:
        """Take the predicted cost of the stages of a pass."""
        self._table.plan(stages)

    def draft(self, table: SteDatabase, refining: str) -> None:
        """Take the figures of a table that is being refined."""
        self._draft = draft_line(table, refining)


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
    case = CASES.of_json(order.inputs["case"])
    file = order.workspace / "database.nc"
    database = database_of(case, order, progress)
    database.to_netcdf(file)
    return (_product(order.key, database, file),)


def _product(key: str, database: SteDatabase, file: Path) -> Product:
    """Return a database in its file as what was made."""
    return Product(key, "database", file, headline=headline_json(database))


def database_of(case: CheckedCase, order: WorkOrder, progress: Progress) -> SteDatabase:
    """Return the STE database of a case of an order; condensed gears are kept in the service's cache."""
    drafted = DraftedProgress(progress, refines=case.case.accuracy.tolerance is not None)
    with boundary_errors(), table_workers(order) as workers:
        run = Run(workers, order.data_directory / "compliance", drafted, drafted.plan)
        return checked_table(case, run, drafted.draft)


def simulate_scene(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Run a scene; tables come from the store, those missing are computed and kept."""
    ordered = ordered_scene(order, progress)
    file = order.workspace / "run.nc"
    _run(ordered.tabled.scene, file, progress)
    stamp_scene(file, scene_metadata(ordered.tabled))
    return (*ordered.products, Product(order.key, "run", file, ordered.warnings))


@dataclass(frozen=True)
class _OrderedScene:
    """The scene of an order with its tables, those of them that had to be computed, and its warnings."""

    tabled: TabledScene
    products: tuple[Product, ...]
    warnings: list[dict[str, Any]]


def ordered_scene(order: WorkOrder, progress: Progress) -> _OrderedScene:
    """Reduce the housings of the scene of an order, gather or compute its tables."""
    housed = housed_scene(order, progress)
    inputs, housings = housed.inputs, housed.housings
    products: list[Product] = []
    databases: dict[str, SteDatabase] = {}
    costs = {mesh.name: float(_stored_key(order, mesh) is None) for _, mesh in inputs.with_database}
    tables = by_cost(partial(progress, "analysis"), costs)
    for index, mesh in inputs.with_database:
        databases[mesh.name] = _table(order, index, mesh, products, partial(tables, mesh.name))
    scene = with_quantity(dynamic_scene(inputs, databases, housings), inputs, housings)
    warnings = {name: database.metadata.warnings for name, database in databases.items()}
    tabled = TabledScene(inputs, databases, scene, housings)
    return _OrderedScene(tabled, tuple(products), scene_warnings(inputs, scene, warnings))


def housed_scene(order: WorkOrder, progress: Progress) -> HousedScene:
    """Reduce the housings of the scene of an order, and read those that were measured."""
    inputs = SceneInput.model_validate_json(json.dumps(order.inputs["scene"]))
    read_responses(inputs)
    return HousedScene(inputs, reduced_in(inputs, order.data_directory, progress))


def _stored_key(order: WorkOrder, mesh: MeshInput) -> str | None:
    """Return the name of the stored database of a mesh, None if it has to be computed."""
    key = name_of_table(mesh)
    return key if key in order.stored else None


def _run(scene: Scene, file: Path, progress: Progress) -> None:
    """Run into the file; go on from where a worker before us died."""
    try:
        status = simulate_to_file(scene, file, resume=True, progress=staged(progress))
    except ResultError:
        status = simulate_to_file(scene, file, progress=staged(progress))
    if not status.usable:
        raise JobFailed(f"The run ended early: {status.name.lower().replace('_', ' ')}.")


def _table(
    order: WorkOrder, index: int, mesh: MeshInput, products: list[Product], report: Report
) -> SteDatabase:
    """Return the database of a mesh, from the store or computed now; what is computed joins `products`."""
    known = _stored_key(order, mesh)
    if known is not None:
        return SteDatabase.from_netcdf(order.stored[known])
    assert mesh.case is not None
    key = name_of_table(mesh)
    file = order.workspace / f"database_{index}.nc"
    if file.is_file():  # of a worker that died after it
        database = SteDatabase.from_netcdf(file)
        products.append(_product(key, database, file))
        return database

    def part(_stage: str, _fraction: float, total: float | None = None, /) -> None:
        report(total or 0.0)

    try:
        database = database_of(CASES.of(mesh.case), order, part)
    except BadInput as error:
        raise error.within(f"meshes[{index}].case") from None
    database.to_netcdf(file)
    products.append(_product(key, database, file))
    return database
