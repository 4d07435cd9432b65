"""The plot of third octaves over the time of a run."""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.acoustics.levels import a_weighting
from dynamics.noise.sound_over_time import BLOCK
from dynamics.types import FloatArray
from lineofaction.report.drawing.figure import Axis, Figure, HeatMap, Panel, Table, number
from lineofaction.report.studies.bearing_force_words import row_axis

Json = dict[str, Any]
DEPTH = 60.0
"""dB shown below the loudest."""


def third_octaves_over_time(facts: Json) -> Figure:
    """Draw the A-weighted bands over the run: impacts, sidebands and free vibration are among them."""
    told = facts["over_time"]
    center = np.array(told["third_octave_hz"])
    level = np.array(told["third_octave_db"]) + a_weighting(center)[:, None]
    total = np.array(told["total_level_db_a"])
    time = np.array(told["time_s"])
    place = np.arange(center.size, dtype=float)
    most, at = float(level.max()), int(total.argmax())
    shown = np.where(level < most - DEPTH, np.nan, level)
    x = Axis("time, s", limits=(float(time[0]), float(time[-1])) if time.size > 1 else None)
    names = tuple((float(k), f"{center[k]:g}") for k in range(0, center.size, 3))
    y = Axis("nominal center of the band, Hz", limits=(-0.5, center.size - 0.5), names=names)
    return Figure(
        key="sound_over_time",
        title="Sound power in third octaves over the run",
        caption="All that the forces on the bearings hold, impacts and sidebands too, from "
        f"{number(told['lowest_hz'], 3)} to {number(told['highest_hz'], 4)} Hz; A-weighted at the centers of "
        f"bands. Blocks of {BLOCK:g} s overlap by half.",
        alternative=f"Loudest at {number(float(time[at]), 3)} s: {total[at]:.1f} dB(A) in all.",
        content=(
            Panel(x, y, shade=HeatMap(time, place, shown, "sound power level, dB(A)", most, most - DEPTH)),
        ),
        table=_table(told),
    )


def _table(told: Json) -> Table:
    """List the total over time."""
    rows = zip(
        told["time_s"], told["speed_rpm"], told["total_level_db"], told["total_level_db_a"], strict=True
    )
    head = ("time, s", "speed, rpm", "dB", "dB(A)")
    return Table(
        "Sound power over the run",
        head,
        tuple(
            (f"{t:.3f}", number(n, 5), f"{level:.1f}", f"{weighted:.1f}") for t, n, level, weighted in rows
        ),
    )


def total_line(speed: FloatArray, facts: Json) -> tuple[FloatArray, FloatArray] | None:
    """Return where on the axis of the orders the run's total lies, and its levels, dB(A); None without."""
    told = facts.get("over_time")
    if told is None:
        return None
    by_time = row_axis(speed, facts)[0].label == "time, s"
    along = np.array(told["time_s" if by_time else "speed_rpm"])
    rising = np.argsort(along, kind="stable")
    return along[rising], np.array(told["total_level_db_a"])[rising]
