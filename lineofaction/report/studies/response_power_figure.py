"""The power that the vibration of a forced response loses: by kind of part over speed, and at its worst."""

from __future__ import annotations

import numpy as np

from dynamics.linearize import ForcedResponse
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Table, number

LEAST_SHARE = 1e-3
"""%, of what is listed."""


def loses_power(response: ForcedResponse) -> bool:
    """Whether any part loses power; files of older versions do not know."""
    return bool(np.any(_total(response) > 0.0))


def power_table(response: ForcedResponse) -> Table:
    """List where the power goes at the speed at which most is lost."""
    power, total = response.power, _total(response)
    at = int(np.argmax(total))
    by_part = np.sum(power.loss[:, at], axis=1)
    rows = []
    for kind, lost in power.by_kind().items():
        own = [part for part, each in enumerate(power.kind) if each == kind]
        most = max(own, key=lambda part: by_part[part])
        share = 100.0 * float(lost[at] / total[at])
        if abs(share) >= LEAST_SHARE:
            rows.append((kind, power.sink[most], number(float(lost[at]), 3), number(share, 3)))
    title = f"Power lost at {number(float(response.speed[at]) / RPM, 4)} rpm, all orders"
    return Table(title, ("lost in", "most in", "W", "%"), tuple(rows))


def power_figure(response: ForcedResponse) -> Figure:
    """Draw what kinds of parts lose over speed."""
    speed, table = response.speed / RPM, power_table(response)
    kinds = {row[0] for row in table.rows}
    ends = (float(speed[0]), float(speed[-1])) if speed.size > 1 else None
    lines = tuple(
        Line(kind, speed, lost, palette.category(index), width=1.4)
        for index, (kind, lost) in enumerate(response.power.by_kind().items())
        if kind in kinds
    )
    panel = Panel(
        Axis(f"speed of {response.facts['leading_shaft']}, rpm", limits=ends), Axis("power lost, W"), lines
    )
    most = max(response.power.by_kind().items(), key=lambda item: float(np.max(item[1])))[0]
    return Figure(
        key="power",
        title="Power lost by the vibration",
        caption=(
            "Mean power of all orders that transmission errors and loads put in, by the parts that take it. "
            "Friction of a mesh may feed the vibration: then its power is negative."
        ),
        alternative=f"At its largest, most of it is lost in parts of the kind {most}.",
        content=(panel,),
        table=table,
    )


def _total(response: ForcedResponse) -> FloatArray:
    """Return what all parts lose, (S,) W."""
    return np.asarray(np.sum(response.power.loss, axis=(0, 2)))
