"""Load sharing of planets over a run."""

from __future__ import annotations

import numpy as np

from dynamics.results import RunResult
from dynamics.results.planet_load_sharing import PlanetLoadSharing, planet_load_sharing
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.envelope import envelope
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Table, number


def planet_sharing(run: RunResult) -> Figure | None:
    """Draw what each planet carries at sun and ring; None without planets."""
    sharings = planet_load_sharing(run)
    if not sharings:
        return None
    rows = tuple(
        (
            sharing.central,
            mesh,
            number(float(mean)),
            number(float(np.nanmin(ratio))),
            number(float(np.nanmax(ratio))),
        )
        for sharing in sharings
        for mesh, mean, ratio in zip(sharing.mesh, sharing.mean, sharing.ratio, strict=True)
    )
    factors = "; ".join(f"{s.central} {number(s.mesh_load_factor)}" for s in sharings)
    return Figure(
        key="planet_sharing",
        title="Load sharing of the planets",
        caption="Force of each planet's mesh times the number of planets over the sum of their forces: 1 "
        "for equal loads.",
        alternative=f"Largest share in the mean (K_gamma): {factors}.",
        content=tuple(_panel(run, sharing) for sharing in sharings),
        table=Table("Load sharing", ("gear", "mesh", "of means", "least", "largest"), rows),
    )


def _panel(run: RunResult, sharing: PlanetLoadSharing) -> Panel:
    """One central gear."""
    lines = []
    for index, ratio in enumerate(sharing.ratio):
        time, values = envelope(run.time, ratio)
        lines.append(Line(f"planet {index + 1}", time, values, palette.category(index), width=1.0))
    ends = (float(run.time[0]), float(run.time[-1]))
    return Panel(
        Axis("time, s", limits=ends), Axis("load sharing ratio"), tuple(lines), title=sharing.central
    )
