"""Warnings in the files that work makes."""

from __future__ import annotations

from collections.abc import Sequence

from service.worker.order import Product, WorkOrder
from service.worker.process import on_demand

stamp = on_demand("service.convert.stamp:stamp")
case_warnings = on_demand("service.worker.input_warnings:warnings_of_case")


def stamp_products(order: WorkOrder, products: Sequence[Product]) -> None:
    """Write into each file what is implausible about what it was made from; a database says so itself."""
    for product in products:
        if product.warnings is not None:
            stamp(product.file, product.warnings)
        elif product.kind != "database" and "case" in order.inputs:
            stamp(product.file, list(case_warnings(order.inputs["case"])))
