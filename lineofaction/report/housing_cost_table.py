"""The table of what the housings of a scene cost beside what was predicted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from lineofaction.report.drawing.figure import Table, number

Json = dict[str, Any]
GIGABYTE = 1e9


HEAD = ("work", "CPU s", "CPU s predicted", "GB", "GB predicted")


UNKNOWN, LEAST = "-", 1e-3


def cost_tables(facts: Mapping[str, Any]) -> tuple[Table, ...]:
    """Return the table of predicted and measured cost of the housings; none without any."""
    rows = tuple(_row(name, cost) for name, cost in _work(facts))
    return (Table("Cost of the housings, once: results are kept", HEAD, rows),) if rows else ()


def _work(facts: Mapping[str, Any]) -> Iterator[tuple[str, Json]]:
    """Yield reductions and radiation resistances, and what they cost."""
    for housing, cost in facts.get("reduction_cost", {}).items():
        yield f"{housing}: reduction", cost
    for housing, radiation in facts.get("radiation", {}).items():
        if "cost" in radiation:
            model = radiation["model_name"].replace("_", " ")
            yield f"{housing}: {model}, all frequencies", radiation["cost"]


def _row(name: str, cost: Json) -> tuple[str, ...]:
    seconds = amount(cost["seconds"]), amount(cost["predicted_seconds"])
    return name, *seconds, gigabytes(cost["bytes"]), gigabytes(cost["predicted_bytes"])


def amount(value: float | None) -> str:
    """Write CPU seconds or GB; less than a thousandth is nothing that anybody weighs."""
    if value is None:
        return UNKNOWN
    return number(value, 2) if value >= LEAST else f"< {LEAST:g}"


def gigabytes(value: float | None) -> str:
    """Write bytes in GB."""
    return amount(None if value is None else value / GIGABYTE)
