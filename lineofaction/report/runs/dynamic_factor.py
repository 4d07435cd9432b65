"""Dynamic factor over a run."""

from __future__ import annotations

import numpy as np

from dynamics.results import RunResult
from dynamics.results.dynamic_factor import dynamic_factor
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, number
from lineofaction.report.runs.run_view import run_axis

PITCHES = 16


def dynamic_factor_figure(run: RunResult) -> Figure:
    """Draw largest, mean and least mesh force over the nominal one."""
    factor = dynamic_factor(run, PITCHES)
    axis, abscissa = run_axis(run, factor.time)
    lines = (
        Line("largest", abscissa, factor.largest, palette.VERMILLION),
        Line("mean", abscissa, factor.mean, palette.INK, "dash"),
        Line("least", abscissa, factor.least, palette.BLUE),
    )
    worst = int(np.argmax(factor.largest))
    unit = axis.label.rpartition(",")[2].strip()
    return Figure(
        key="dynamic_factor",
        title=f"Dynamic factor of {run.mesh[0]}",
        caption=f"Force of the driving flank over the nominal one, in blocks of {PITCHES} pitches. "
        "The largest is the dynamic factor K_v; where the least is 0 the flanks lift off. The mean "
        "differs from 1 by the torque that accelerates the train.",
        alternative=f"Largest {number(float(factor.largest[worst]), 4)} at "
        f"{number(float(abscissa[worst]), 3)} {unit}, least {number(float(factor.least.min()), 3)}.",
        content=(Panel(axis, Axis("mesh force over nominal, 1"), lines),),
    )
