"""Warnings in the files that work makes; light, as every worker loads it."""

from __future__ import annotations

from collections.abc import Sequence

from lineofaction.gearbox.loading import on_demand
from service.worker.order import Product, WorkOrder

stamp = on_demand("lineofaction.gearbox.convert.result_files:stamp")
warnings_of_case = on_demand("service.worker.input_warnings:warnings_of_case")


def stamp_products(order: WorkOrder, products: Sequence[Product]) -> None:
    """Write into each file what is implausible about what it was made from; a database says so itself."""
    others = any(product.kind != "database" for product in products)
    case = list(warnings_of_case(order.inputs["case"])) if others and "case" in order.inputs else None
    for product in products:
        of_case = None if product.kind == "database" else case
        if product.warnings is not None or of_case is not None:
            warnings = (*(of_case or ()), *(product.warnings or ()))
            stamp(product.file, list({warning["message"]: warning for warning in warnings}.values()))
