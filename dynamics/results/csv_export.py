"""Run results as comma-separated values."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dynamics.results.run_result import RunResult
from dynamics.results.series import LABELS, SERIES
from dynamics.types import FloatArray


def write_csv(result: RunResult, path: Path) -> None:
    """Write time and every series over time, 9 significant digits, e.g. ``mesh_force[mesh 1] (N)``."""
    names, columns = ["time (s)"], [result.time]
    for series in SERIES:
        if series.dimensions[-1] != "time":
            continue
        values = getattr(result, series.name)
        if not values.size:
            continue
        labels = _labels(result, series.dimensions[:-1])
        for label, column in zip(labels, values.reshape(-1, result.time.size), strict=True):
            names.append(f"{series.name}{label} ({series.units})")
            columns.append(column)
    table: FloatArray = np.stack(columns, axis=1)
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=",".join(names), comments="")


def _labels(result: RunResult, dimensions: tuple[str, ...]) -> list[str]:
    """One suffix per row of the leading dimensions."""
    if not dimensions:
        return [""]
    names = getattr(result, {dimension: field for field, dimension in LABELS.items()}[dimensions[0]])
    if len(dimensions) == 1:
        return [f"[{name}]" for name in names]
    return [f"[{name} {direction}]" for name in names for direction in "xyz"]
