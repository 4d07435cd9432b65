"""A run in a dozen lines: duration, end, forces and motions of meshes, bearings, cost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

import numpy as np

from bounds import engineering
from bounds.brief import Row
from dynamics.types import FloatArray, Json, RunStatus

MAX_PARTS = 3
"""Most meshes and bearings that are listed, those with the largest forces."""


class Run(Protocol):
    """Fields of a run that its headlines show, as `RunResult` has them."""

    @property
    def time(self) -> FloatArray: ...  # noqa: D102
    @property
    def status(self) -> RunStatus: ...  # noqa: D102
    @property
    def receipt(self) -> Json: ...  # noqa: D102
    @property
    def mesh(self) -> Sequence[str]: ...  # noqa: D102
    @property
    def bearing(self) -> Sequence[str]: ...  # noqa: D102
    @property
    def least_mesh_force(self) -> FloatArray: ...  # noqa: D102
    @property
    def largest_mesh_force(self) -> FloatArray: ...  # noqa: D102
    @property
    def dynamic_transmission_error(self) -> FloatArray: ...  # noqa: D102
    @property
    def bearing_force(self) -> FloatArray: ...  # noqa: D102


def headlines(run: Run) -> tuple[str, list[Row]]:
    """Return the title of a run and its rows."""
    duration = float(run.time[-1] - run.time[0]) if run.time.size else 0.0
    title = f"RunResult, {engineering(duration, 4)} s in {run.time.size} samples, {run.status.name.lower()}"
    parts = ("shaft", "mesh", "bearing", "drive", "coupling")
    counts = ((len(getattr(run, part)), part) for part in parts)
    listed = ", ".join(_counted(count, part) for count, part in counts if count)
    rows = [("parts", listed), *_meshes(run), *_bearings(run)]
    cost = run.receipt.get("cpu_seconds")
    if cost is not None:
        rows.append(("made", f"{engineering(float(cost), 3)} CPU s"))
    return title, rows


def _counted(count: int, part: str) -> str:
    ending = "" if count == 1 else "es" if part.endswith("sh") else "s"
    return f"{count} {part}{ending}"


def _meshes(run: Run) -> Iterator[Row]:
    """Yield transverse force, between samples as within them, and dynamic transmission error of meshes."""
    if not run.time.size:
        return
    least = run.least_mesh_force.min(axis=1, initial=np.inf)
    largest = run.largest_mesh_force.max(axis=1, initial=0.0)
    for at in np.argsort(-largest)[:MAX_PARTS]:
        force = f"{engineering(float(least[at]), 3)} to {engineering(float(largest[at]), 4)}"
        error = 1e6 * run.dynamic_transmission_error[at]
        swing = engineering(float(np.ptp(error)), 3)
        yield (
            f"mesh {run.mesh[at]}",
            f"force {force} N, transmission error mean {engineering(float(error.mean()), 4)} µm, "
            f"peak-to-peak {swing} µm",
        )


def _bearings(run: Run) -> Iterator[Row]:
    """Yield the largest radial force on bearings."""
    if not run.bearing_force.size:
        return
    radial = np.hypot(run.bearing_force[:, 0], run.bearing_force[:, 1]).max(axis=1)
    for at in np.argsort(-radial)[:MAX_PARTS]:
        yield f"bearing {run.bearing[at]}", f"radial force up to {engineering(float(radial[at]), 4)} N"
