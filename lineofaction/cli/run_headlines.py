"""The main figures of a run: how far its forces swing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lineofaction.report.drawing.figure import number
from lineofaction.report.drawing.page import Headline


def run_headlines(peaks: Mapping[str, Any]) -> tuple[Headline, ...]:
    """Return the largest mesh force, and the largest force on a bearing, from the `peaks` of a receipt."""
    meshes = {name: (force["peak"], force["rms"]) for name, force in peaks.get("mesh_force", {}).items()}
    bearings = {
        f"{name}, {axis}": (peak, rms)
        for name, force in peaks.get("bearing_force", {}).items()
        for axis, peak, rms in zip("xyz", force["peak"], force["rms"], strict=True)
    }
    return tuple(
        _largest(what, forces)
        for what, forces in (("mesh force of", meshes), ("force on bearing", bearings))
        if forces
    )


def _largest(what: str, forces: dict[str, tuple[float, float]]) -> Headline:
    """Name the part with the largest peak."""
    name = max(forces, key=lambda part: forces[part][0])
    peak, rms = forces[name]
    return Headline(f"largest {what} {name}", f"{number(peak, 4)} N", f"rms {number(rms, 4)} N")
