"""What the housings of a scene cost beside what was predicted: facts of results, their figures, the table."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any, TypeVar

from service.drawing.figure import Table, number

if TYPE_CHECKING:
    from service.convert.scene import TabledScene

Json = dict[str, Any]
Result = TypeVar("Result")
GIGABYTE = 1e9
HEAD = ("work", "CPU s", "CPU s predicted", "GB", "GB predicted")
UNKNOWN, LEAST = "-", 1e-3


def with_housing_costs(compute: Callable[..., Result]) -> Callable[..., Result]:
    """Return the work of a study on a scene as one on a `TabledScene`, with the fact `reduction_cost`."""

    def computed(subject: TabledScene, *means: Any) -> Result:
        result: Any = compute(subject.scene, *means)
        whole: Result = replace(result, facts={**result.facts, "reduction_cost": reduction_costs(subject)})
        return whole

    return computed


def reduction_costs(subject: TabledScene) -> Json:
    """Return the fields of the `WorkCost` of reductions by housing; a file of modes may be without them."""
    return {name: asdict(body.cost) for name, body in subject.housings.items() if body.cost is not None}


def reduction_figures(facts: Mapping[str, Any]) -> Json:
    """Return the figures of the reductions by housing; none of results of versions that did not know them."""
    return {name: cost_figures(cost) for name, cost in facts.get("reduction_cost", {}).items()}


def cost_figures(cost: Json | None) -> Json | None:
    """Return the figures of a `HousingCost` from the fields of a `WorkCost`."""
    if cost is None:
        return None
    return {
        "predicted_cpu_seconds": cost["predicted_seconds"],
        "predicted_bytes": cost["predicted_bytes"],
        "cpu_seconds": cost["seconds"],
        "bytes": cost["bytes"],
    }


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
    """Describe a cost."""
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
