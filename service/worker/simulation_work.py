"""The work of the process simulate, done in a child process of its own."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from dynamics.errors import ResultError
from dynamics.scene import Scene
from dynamics.simulation import simulate_to_file
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.case import case_json
from lineofaction.gearbox.convert.housings import HousedScene, reduced_in
from lineofaction.gearbox.convert.plausibility import scene_warnings
from lineofaction.gearbox.convert.runs import staged
from lineofaction.gearbox.convert.scene import TabledScene, dynamic_scene
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.scene_meshes import MeshInput
from model_studies.progress import Report, by_cost
from service.store import ResultStore, stored_results
from service.worker.analysis_work import database_of
from service.worker.catalogue import ANALYZE
from service.worker.order import Product, Progress, WorkOrder


def simulate_scene(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Run a scene; tables come from the store, those missing are computed and kept."""
    ordered = ordered_scene(order, progress)
    file = order.workspace / "run.nc"
    _run(ordered.tabled.scene, file, progress)
    return (*ordered.products, Product(order.key, "run", file, ordered.warnings))


@dataclass(frozen=True)
class OrderedScene:
    """The scene of an order with its tables, those of them that had to be computed, and its warnings."""

    tabled: TabledScene
    products: tuple[Product, ...]
    warnings: list[dict[str, Any]]


def ordered_scene(order: WorkOrder, progress: Progress) -> OrderedScene:
    """Reduce the housings of the scene of an order, gather or compute its tables."""
    housed = housed_scene(order, progress)
    inputs, housings = housed.inputs, housed.housings
    products: list[Product] = []
    databases: dict[str, SteDatabase] = {}
    costs = {mesh.name: float(_stored_key(order, mesh) is None) for _, mesh in inputs.with_database}
    tables = by_cost(partial(progress, "analysis"), costs)
    for index, mesh in inputs.with_database:
        databases[mesh.name] = _table(order, index, mesh, products, partial(tables, mesh.name))
    scene = dynamic_scene(inputs, databases, housings)
    warnings = {name: database.metadata.warnings for name, database in databases.items()}
    tabled = TabledScene(inputs, databases, scene, housings)
    return OrderedScene(tabled, tuple(products), scene_warnings(inputs, scene, warnings))


def housed_scene(order: WorkOrder, progress: Progress) -> HousedScene:
    """Reduce the housings of the scene of an order."""
    inputs = SceneInput.model_validate_json(json.dumps(order.inputs["scene"]))
    return HousedScene(inputs, reduced_in(inputs, order.data_directory, progress))


def store_of(order: WorkOrder) -> ResultStore:
    """Return the store of an order."""
    place = order.database_url, order.results_url, order.results_keys
    return stored_results(order.data_directory, *place).within(order.project)


def _stored_key(order: WorkOrder, mesh: MeshInput) -> str | None:
    """Return the name of the stored database of a mesh, None if it has to be computed."""
    if mesh.case is None:
        return str(mesh.database_hash)
    key = ANALYZE.key({"case": case_json(mesh.case)})
    return None if store_of(order).find(key, "database") is None else key


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
        return SteDatabase.from_netcdf(store_of(order).verified(known, "database").path)
    assert mesh.case is not None
    key = ANALYZE.key({"case": case_json(mesh.case)})
    file = order.workspace / f"database_{index}.nc"
    if file.is_file():  # of a worker that died after it
        products.append(Product(key, "database", file))
        return SteDatabase.from_netcdf(file)

    def part(_stage: str, _fraction: float, whole: float | None = None, /) -> None:
        report(whole or 0.0)

    try:
        database = database_of(mesh.case, order, part)
    except BadInput as error:
        raise error.within(f"meshes[{index}].case") from None
    database.to_netcdf(file)
    products.append(Product(key, "database", file))
    return database
