"""A run in a dozen lines: duration, end, forces and motions of meshes, bearings, cost."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from bounds import engineering
from bounds.brief import Row

if TYPE_CHECKING:
    from dynamics.results.run_result import RunResult

MOST_PARTS = 3
"""Meshes and bearings that are listed, those of the largest forces."""


def headlines(run: RunResult) -> tuple[str, list[Row]]:
    """Return the title of a run and its rows."""
    duration = float(run.time[-1] - run.time[0]) if run.time.size else 0.0
    title = f"RunResult, {engineering(duration, 4)} s in {run.time.size} samples, {run.status.name.lower()}"
    parts = ("shaft", "mesh", "bearing", "drive", "coupling")
    counts = (f"{len(getattr(run, part))} {part}" for part in parts if getattr(run, part))
    rows = [("parts", ", ".join(counts)), *_meshes(run), *_bearings(run)]
    cost = run.receipt.get("cpu_seconds")
    if cost is not None:
        rows.append(("made", f"{engineering(float(cost), 3)} CPU s"))
    return title, rows


def _meshes(run: RunResult) -> Iterator[Row]:
    """Yield transverse force and dynamic transmission error of meshes."""
    if not run.time.size:
        return
    most = run.mesh_force.max(axis=1, initial=0.0)
    for at in np.argsort(-most)[:MOST_PARTS]:
        force, error = run.mesh_force[at], 1e6 * run.dynamic_transmission_error[at]
        swing = engineering(float(np.ptp(error)), 3)
        yield (
            f"mesh {run.mesh[at]}",
            f"force {_range(force)} N, transmission error mean {engineering(float(error.mean()), 4)} µm, "
            f"peak-to-peak {swing} µm",
        )


def _bearings(run: RunResult) -> Iterator[Row]:
    """Yield the largest radial force on bearings."""
    if not run.bearing_force.size:
        return
    radial = np.hypot(run.bearing_force[:, 0], run.bearing_force[:, 1]).max(axis=1)
    for at in np.argsort(-radial)[:MOST_PARTS]:
        yield f"bearing {run.bearing[at]}", f"radial force up to {engineering(float(radial[at]), 4)} N"


def _range(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> str:
    return f"{engineering(float(values.min()), 3)} to {engineering(float(values.max()), 4)}"
