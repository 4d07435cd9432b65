"""The work of the process ablate, done in a child process of its own."""

from __future__ import annotations

import json

from dynamics.ablation import Ablation as SceneAblation
from fe_contact.analysis.ablation import Ablation
from service.convert.ablation import ablation_json, ablation_of_case, ablation_of_scene
from service.jobs.order import Product, Progress, WorkOrder
from service.jobs.simulation_work import ordered_scene
from service.schemas import Case

STAGE = "ablation"


def switch_effects(order: WorkOrder, progress: Progress) -> tuple[Product, ...]:
    """Toggle the effects of a case or a scene, into a JSON file."""
    file = order.workspace / "ablation.json"
    products: tuple[Product, ...] = ()
    warnings = None
    found: Ablation | SceneAblation
    if "scene" in order.inputs:
        ordered = ordered_scene(order, progress)
        products, warnings = ordered.products, ordered.warnings
        found = ablation_of_scene(ordered.scene, order.inputs["only"], lambda _, done: progress(STAGE, done))
    else:
        case = Case.model_validate_json(json.dumps(order.inputs["case"]))
        found = ablation_of_case(case, order.inputs["only"], order.data_directory / "compliance", progress)
    file.write_text(f"{json.dumps(ablation_json(found), allow_nan=False)}\n", encoding="utf-8")
    return (*products, Product(order.key, "ablation", file, warnings))
