"""The work of the process simulate, done in a child process of its own."""

from __future__ import annotations

import json
from pathlib import Path

from dynamics.errors import ResultError
from dynamics.simulate import simulate_to_file
from dynamics.system import Scene
from fe_contact.ste import SteDatabase
from service.convert.case import case_json
from service.convert.runs import staged
from service.convert.scene import dynamic_scene
from service.jobs.analysis_work import database_of
from service.jobs.catalogue import ANALYZE
from service.jobs.order import Product, Progress, WorkOrder
from service.problems import BadInput, JobFailed
from service.schemas.scene import MeshInput, SceneInput
from service.store import stored_results


def simulate_scene(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Run a scene; tables come from the store, those missing are computed and kept."""
    scene, products = ordered_scene(order, progress)
    file = order.workspace / "run.nc"
    _run(scene, file, progress)
    return (*products, Product(order.key, "run", file))


def ordered_scene(order: WorkOrder, progress: Progress) -> tuple[Scene, list[Product]]:
    """Return the scene of an order with its tables, and those of them that had to be computed."""
    scene = SceneInput.model_validate_json(json.dumps(order.inputs["scene"]))
    products: list[Product] = []
    databases: dict[str, SteDatabase] = {}
    for index, mesh in enumerate(scene.meshes):
        databases[mesh.name] = _table(order, index, mesh, products, progress)
    return dynamic_scene(scene, databases), products


def _run(scene: Scene, file: Path, progress: Progress) -> None:
    """Run into the file; go on from where a worker before us died."""
    try:
        status = simulate_to_file(scene, file, resume=True, progress=staged(progress))
    except ResultError:
        status = simulate_to_file(scene, file, progress=staged(progress))
    if not status.usable:
        raise JobFailed(f"The run ended early: {status.name.lower().replace('_', ' ')}.")


def _table(
    order: WorkOrder, index: int, mesh: MeshInput, products: list[Product], progress: Progress
) -> SteDatabase:
    """Return the database of a mesh, from the store or computed now; what is computed joins `products`."""
    store = stored_results(order.data_directory, order.database_url, order.results_url)
    if mesh.case is None:
        return SteDatabase.from_netcdf(store.verified(str(mesh.database_hash), "database").path)
    key = ANALYZE.key({"case": case_json(mesh.case)})
    if store.find(key, "database") is not None:
        return SteDatabase.from_netcdf(store.verified(key, "database").path)

    file = order.workspace / f"database_{index}.nc"
    if file.is_file():  # of a worker that died after it
        products.append(Product(key, "database", file))
        return SteDatabase.from_netcdf(file)

    def part(stage: str, fraction: float) -> None:
        progress("analysis", ANALYZE.overall(stage, fraction) or 0.0)

    try:
        database = database_of(mesh.case, order, part)
    except BadInput as error:
        raise error.within(f"meshes[{index}].case") from None
    database.to_netcdf(file)
    products.append(Product(key, "database", file))
    return database
