"""The work of the studies of scenes without time integration, done in a child process of its own."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from dynamics.scene import Scene
from service.convert.modal import modes_of
from service.convert.response import response_of
from service.convert.steady import steady_of
from service.jobs.order import Product, Progress, WorkOrder
from service.jobs.simulation_work import ordered_scene
from service.schemas.dynamic_studies import ModesInput, ResponseInput, SteadyInput
from service.schemas.model import BoundaryModel


def study_modes(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Find the modes of a scene."""
    return _study(order, progress, "modes", ModesInput, modes_of)


def study_response(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Find the forced response of a scene."""
    return _study(order, progress, "response", ResponseInput, response_of)


def study_steady(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Find the periodic steady states of a scene."""
    return _study(order, progress, "steady", SteadyInput, steady_of)


def _study(
    order: WorkOrder,
    progress: Progress,
    kind: str,
    model: type[BoundaryModel],
    run: Callable[[Scene, Any, Progress], Any],
) -> tuple[Product, ...]:
    """Run a study of the scene of an order, into a file."""
    ordered = ordered_scene(order, progress)
    varied = {name: value for name, value in order.inputs.items() if name != "scene"}
    file = order.workspace / f"{kind}.nc"
    run(ordered.scene, model.model_validate_json(json.dumps(varied)), progress).to_netcdf(file)
    return (*ordered.products, Product(order.key, kind, file, ordered.warnings))
