"""Contributions of bearings and modes to a velocity: rows of a table and bars, and a velocity in words."""

from __future__ import annotations

import numpy as np

from bounds.types import FloatArray
from dynamics.vibration.vibration_analysis import Shares
from lineofaction.gearbox.studies.vibration.run import MM_PER_S
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Panel, largest, number

MAX_PARTS, MAX_MODES = 12, 8
"""Most contributions in the table, and in the bars."""


def share_rows(shares: Shares, with_surface: bool) -> list[tuple[str, ...]]:
    """Return the rows of the largest contributions in %: a column for each point, and one of the surface."""
    contributions = np.vstack([shares.point, shares.surface]) if with_surface else shares.point
    drawn = largest(np.max(np.abs(contributions), axis=0), MAX_PARTS)
    return [
        (
            shares.name[p],
            number(shares.frequency[p], 5) if np.isfinite(shares.frequency[p]) else "",
            *(f"{100.0 * float(value):.1f}" for value in contributions[:, p]),
        )
        for p in drawn
    ]


def share_panel(shares: Shares, part: FloatArray) -> Panel:
    """Draw contributions (p,) as bars that add up to 100 %, the small ones together."""
    drawn = largest(np.abs(part), MAX_MODES)
    values = [100.0 * float(part[p]) for p in drawn]
    names = [_name(shares, p) for p in drawn]
    if len(drawn) < part.size:
        names.append("others")
        values.append(100.0 - sum(values))
    x, width = np.arange(float(len(names))), 0.6
    bars = Bars("contribution", x, np.array(values), base=0.0, width=width, color=palette.BLUE)
    return Panel(Axis.of_names(names), Axis("contribution, %"), bars=(bars,))


def _name(shares: Shares, index: int) -> str:
    hertz = float(shares.frequency[index])
    return f"{number(hertz, 4)} Hz" if np.isfinite(hertz) else shares.name[index]


def velocity_text(rms: float) -> str:
    """Return a root mean square velocity, m/s, as text."""
    return f"{number(rms / MM_PER_S, 3)} mm/s rms"
