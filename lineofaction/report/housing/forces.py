"""Forces behind the vibration and the sound of a housing, and the sound of a run's forces over time."""

from __future__ import annotations

import numpy as np

from bounds.types import Json
from dynamics.acoustics.levels import a_weighting
from dynamics.noise.sound_over_time import BLOCK
from dynamics.types import FloatArray
from lineofaction.gearbox.schemas.figures import LINEAR
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing.figure import Axis, Figure, Panel, Table, number, shaded_levels
from lineofaction.report.response.excitations import orders_left_out

COARSE = 10.0 ** (1.0 / 20.0) - 1.0
"""Smearing by 1 dB: above it a window does not resolve an order."""

DEPTH, LABEL = 60.0, "sound power level, dB(A)"
"""dB shown below the loudest."""


def of_run(metadata: Json) -> Json | None:
    """Return the facts `forces` of a result if they are a run's; None for the linear response."""
    forces: Json = metadata.get("forces", LINEAR)
    return forces if forces["source"] == "run" else None


def row_axis(speed: FloatArray, metadata: Json) -> tuple[Axis, FloatArray]:
    """Return the axis of the rows: their speed (S,) in rad/s where it rises all along, else the time."""
    run = of_run(metadata)
    if run is not None and not np.all(np.diff(speed) > 1e-6 * speed[:-1]):
        time = np.array(run["time_s"])
        return Axis.over("time, s", time), time
    return Axis.over(f"speed of {metadata['leading_shaft']}, rpm", speed / RPM), speed / RPM


def force_rows(metadata: Json) -> tuple[tuple[str, str], ...]:
    """Say whose forces on bearings a result rests on, and how far the orders of a run hold."""
    run = of_run(metadata)
    if run is None:
        about = ("forces on bearings", "linear steady response: stiffness varies, flanks in contact")
        return (about, *orders_left_out(metadata))
    windows = f"{len(run['time_s'])} windows of {run['window_pitches']} base pitches"
    if run["windows_left_out"]:
        windows += f", {run['windows_left_out']} left out: standstill, or too fast a change of speed"
    rows = [("forces on bearings", f"orders of the run, {windows}")]
    rows += [
        (f"housing {name}", "not that in which the run moved: its forces lack what this one does")
        for name in run.get("other_housings", ())
    ]
    maximum = {name: max(shares) for name, shares in run["remainder"].items()}
    bearing = max(maximum, key=lambda name: maximum[name])
    remainder = f"at most {number(100.0 * maximum[bearing], 3)} % of the force on {bearing}, in variance"
    rows.append(("what orders do not hold", remainder))
    if run["smearing"] is None:
        rows.append(("smearing by the windows", "not known: the run states no modes"))
        return tuple(rows)
    smearing = np.array(run["smearing"])
    coarse = int(np.sum(np.any(smearing > COARSE, axis=0)))
    smearing_text = f"median {number(20.0 * np.log10(1.0 + float(np.median(smearing))), 2)} dB"
    if coarse:
        smearing_text += f"; above 1 dB in {coarse} windows: run up more slowly"
    rows.append(("smearing by the windows", smearing_text))
    return tuple(rows)


def third_octaves_over_time(metadata: Json) -> Figure:
    """Draw the A-weighted bands over the run: impacts, sidebands and free vibration are among them."""
    course = metadata["over_time"]
    center = np.array(course["third_octave_hz"])
    level = np.array(course["third_octave_db"]) + a_weighting(center)[:, None]
    total = np.array(course["total_level_db_a"])
    time = np.array(course["time_s"])
    band = np.arange(center.size, dtype=float)
    at, x = int(total.argmax()), Axis.over("time, s", time)
    names = tuple((float(k), f"{center[k]:g}") for k in range(0, center.size, 3))
    y = Axis("nominal center of the band, Hz", limits=(-0.5, center.size - 0.5), names=names)
    return Figure(
        key="sound_over_time",
        title="Sound power in third octaves over the run",
        caption="All that the forces on the bearings hold, impacts and sidebands too, from "
        f"{number(course['lowest_hz'], 3)} to {number(course['highest_hz'], 4)} Hz; A-weighted at the "
        f"centers of bands. Blocks of {BLOCK:g} s overlap by half.",
        alternative=f"Loudest at {number(time[at], 3)} s: {total[at]:.1f} dB(A) in all.",
        content=(Panel(x, y, shade=shaded_levels(time, band, level, LABEL, DEPTH)),),
        table=_over_time_table(course),
    )


def _over_time_table(course: Json) -> Table:
    columns = {
        "time, s": lambda row: f"{row[0]:.3f}",
        "speed, rpm": lambda row: number(row[1], 5),
        "dB": lambda row: f"{row[2]:.1f}",
        "dB(A)": lambda row: f"{row[3]:.1f}",
    }
    names = ("time_s", "speed_rpm", "total_level_db", "total_level_db_a")
    return Table.of("Sound power over the run", zip(*(course[name] for name in names), strict=True), columns)


def total_line(speed: FloatArray, metadata: Json) -> tuple[FloatArray, FloatArray] | None:
    """Return where on the axis of the orders the run's total lies, and its levels, dB(A); None without."""
    course = metadata.get("over_time")
    if course is None:
        return None
    by_time = row_axis(speed, metadata)[0].label == "time, s"
    along = np.array(course["time_s" if by_time else "speed_rpm"])
    rising = np.argsort(along, kind="stable")
    return along[rising], np.array(course["total_level_db_a"])[rising]
