"""The work of the process optimise, done in a child process of its own."""

from __future__ import annotations

import json

from service.convert.optimisation import optimisation_json, optimisation_of
from service.jobs.cluster import cluster_of
from service.jobs.order import Product, Progress, WorkOrder
from service.schemas import Case
from service.schemas.optimisation import OptimisationInput


def optimise_flanks(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Optimise the modifications of a case, into a JSON file."""
    inputs = dict(order.inputs)
    case = Case.model_validate_json(json.dumps(inputs.pop("case")))
    study = OptimisationInput.model_validate_json(json.dumps(inputs))
    with cluster_of(order) as workers:
        kept = order.data_directory  # designs too: another attempt, or another deadline, goes on from them
        found = optimisation_of(case, study, kept / "compliance", progress, workers, memory=kept / "searches")
    file = order.workspace / "optimisation.json"
    file.write_text(f"{json.dumps(optimisation_json(found), allow_nan=False)}\n", encoding="utf-8")
    return (Product(order.key, "optimisation", file),)
