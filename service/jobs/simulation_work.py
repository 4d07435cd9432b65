"""The work of the process simulate, done in a child process of its own."""

from __future__ import annotations

import json

from dynamics.simulate import simulate
from fe_contact.ste import SteDatabase
from service.convert.case import case_json
from service.convert.runs import staged
from service.convert.scene import dynamic_scene
from service.jobs.analysis_work import database_of
from service.jobs.catalogue import ANALYZE
from service.jobs.order import Product, Progress, WorkOrder
from service.problems import BadInput
from service.schemas.scene import MeshInput, SceneInput
from service.store import stored_results


def simulate_scene(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Run a scene; tables come from the store, those missing are computed and kept."""
    scene = SceneInput.model_validate_json(json.dumps(order.inputs["scene"]))
    products: list[Product] = []
    databases: dict[str, SteDatabase] = {}
    for index, mesh in enumerate(scene.meshes):
        databases[mesh.name] = _table(order, index, mesh, products, progress)
    file = order.workspace / "run.nc"
    simulate(dynamic_scene(scene, databases), progress=staged(progress)).to_netcdf(file)
    return (*products, Product(order.key, "run", file))


def _table(
    order: WorkOrder, index: int, mesh: MeshInput, products: list[Product], progress: Progress
) -> SteDatabase:
    """Return the database of a mesh, from the store or computed now; what is computed joins `products`."""
    store = stored_results(order.data_directory)
    if mesh.case is None:
        return SteDatabase.from_netcdf(store.verified(str(mesh.database_hash), "database").path)
    key = ANALYZE.key({"case": case_json(mesh.case)})
    if store.find(key, "database") is not None:
        return SteDatabase.from_netcdf(store.verified(key, "database").path)

    def part(stage: str, fraction: float) -> None:
        progress("analysis", ANALYZE.overall(stage, fraction) or 0.0)

    try:
        database = database_of(mesh.case, order.data_directory / "compliance", part)
    except BadInput as error:
        raise error.within(f"meshes[{index}].case") from None
    file = order.workspace / f"database_{index}.nc"
    database.to_netcdf(file)
    products.append(Product(key, "database", file))
    return database
