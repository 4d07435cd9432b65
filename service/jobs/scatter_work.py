"""The work of the process scatter, done in a child process of its own."""

from __future__ import annotations

import json

from service.convert.scatter import sampling_of, scatter_json, scatter_of_case
from service.jobs.cluster import cluster_of
from service.jobs.order import Product, Progress, WorkOrder
from service.schemas import Case
from service.schemas.sampling import SamplingInput


def draw_pairs(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Draw the pairs of a case, into a JSON file; the tasks go to the cluster if there is one."""
    inputs = dict(order.inputs)
    case = Case.model_validate_json(json.dumps(inputs.pop("case")))
    sampling = sampling_of(SamplingInput.model_validate_json(json.dumps(inputs)))
    with cluster_of(order) as workers:
        found = scatter_of_case(case, sampling, order.data_directory / "compliance", progress, workers)
    file = order.workspace / "scatter.json"
    file.write_text(f"{json.dumps(scatter_json(found), allow_nan=False)}\n", encoding="utf-8")
    return (Product(order.key, "scatter", file),)
