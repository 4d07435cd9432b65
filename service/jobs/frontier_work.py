"""The work of the process frontier, done in a child process of its own."""

from __future__ import annotations

import json

from dynamics.accuracy import Frontier as SceneFrontier
from fe_contact.analysis.frontier import Frontier
from service.convert.frontier import frontier_of
from service.convert.run_frontier import run_frontier_of
from service.jobs.order import Product, Progress, WorkOrder
from service.jobs.simulation_work import ordered_scene
from service.schemas import Case


def climb_ladder(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Run the ladder on a case or a scene, into a JSON file."""
    file = order.workspace / "frontier.json"
    products: tuple[Product, ...] = ()
    warnings = None
    found: Frontier | SceneFrontier
    if "scene" in order.inputs:
        ordered = ordered_scene(order, progress)
        products, warnings = ordered.products, ordered.warnings
        found = run_frontier_of(ordered.scene, order.inputs["rungs"], progress)
    else:
        case = Case.model_validate_json(json.dumps(order.inputs["case"]))
        full_contact = order.inputs.get("full_contact")
        found = frontier_of(case, order.inputs["rungs"], progress, full_contact=full_contact)
    file.write_text(f"{json.dumps(found.to_json(), allow_nan=False)}\n", encoding="utf-8")
    return (*products, Product(order.key, "frontier", file, warnings))
