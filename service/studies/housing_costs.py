"""What the work on housings cost beside what was predicted: figures and the table of terminal and report."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from service.drawing.figure import Table, number

if TYPE_CHECKING:
    from dynamics.housing_modes import ReducedHousing

Json = dict[str, Any]
GIGABYTE = 1e9
HEAD = ("work", "CPU s", "CPU s predicted", "GB", "GB predicted")
UNKNOWN, LEAST = "-", 1e-3


def reduction_cost_of(housing: ReducedHousing) -> Json | None:
    """Return the fields of the `WorkCost` of a housing's reduction; None where nobody measured it."""
    return None if housing.cost is None else asdict(housing.cost)


def cost_figures(cost: Json | None) -> Json | None:
    """Return the figures of a `HousingCost` from the fields of a `WorkCost`; None where nobody measured."""
    if cost is None:
        return None
    return {
        "predicted_cpu_seconds": cost["predicted_seconds"],
        "predicted_bytes": cost["predicted_bytes"],
        "cpu_seconds": cost["seconds"],
        "bytes": cost["bytes"],
    }


def cost_table(work: Iterable[tuple[str, Json | None]]) -> Table:
    """List what was predicted and measured; `work` is names and fields of a `WorkCost`."""
    rows = tuple((name, *_row(cost)) for name, cost in work if cost is not None)
    return Table("Cost of the housings, once: results are kept", HEAD, rows)


def _row(cost: Json) -> tuple[str, ...]:
    """Describe a cost."""
    return (
        amount(cost["seconds"]),
        amount(cost["predicted_seconds"]),
        gigabytes(cost["bytes"]),
        gigabytes(cost["predicted_bytes"]),
    )


def amount(value: float | None) -> str:
    """Write CPU seconds or GB; less than a thousandth is nothing that anybody weighs."""
    if value is None:
        return UNKNOWN
    return number(value, 2) if value >= LEAST else f"< {LEAST:g}"


def gigabytes(value: float | None) -> str:
    """Write bytes in GB."""
    return amount(None if value is None else value / GIGABYTE)
