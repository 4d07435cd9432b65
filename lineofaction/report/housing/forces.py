"""Forces behind the vibration and the sound of a housing, and the sound of a run's forces over time.

The forces on the bearings are those of the linear response, or those of a run. A run is analyzed by orders in
windows of some base pitches. Smearing is the part by which a window rounds off the amplitude of a resonance
that the run passes while the window lasts. The remainder is the part of the force's variance that no order
holds.
"""

from __future__ import annotations

import numpy as np

from bounds.types import Json
from dynamics.acoustics.levels import a_weighting
from dynamics.noise.sound_over_time import BLOCK
from dynamics.types import FloatArray
from lineofaction.gearbox.schemas.figures import LINEAR
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing.figure import Axis, Figure, Panel, Table, number, shaded_levels
from lineofaction.report.response.excitations import omitted_orders

COARSE = 10.0 ** (1.0 / 20.0) - 1.0
"""Smearing of 1 dB, as a part of the amplitude, above which a window does not resolve an order."""

DEPTH = 60.0
"""Range of levels below the loudest one that the figure shows, dB."""
LABEL = "sound power level, dB(A)"


def of_run(metadata: Json) -> Json | None:
    """Return the metadata `forces` of a result by a run; None: they are of the linear response."""
    forces: Json = metadata.get("forces", LINEAR)
    return forces if forces["source"] == "run" else None


def row_axis(speed: FloatArray, metadata: Json) -> tuple[Axis, FloatArray]:
    """Return the axis of the rows of a map, and its values (S,).

    It is the speed (S,), rad/s, in rpm, if the speed rises from every row to the next, else the time in s.
    """
    run = of_run(metadata)
    rises = np.all(np.diff(speed) > 1e-6 * speed[:-1])  # a speed that is constant to rounding does not
    if run is not None and not rises:
        time = np.array(run["time_s"])
        return Axis.over("time, s", time), time
    return Axis.over(f"speed of {metadata['leading_shaft']}, rpm", speed / RPM), speed / RPM


def force_rows(metadata: Json) -> tuple[tuple[str, str], ...]:
    """Return rows of name and text: the source of the forces on bearings, and the limits of its orders."""
    run = of_run(metadata)
    if run is None:
        about = ("forces on bearings", "linear steady response: stiffness varies, flanks in contact")
        return (about, *omitted_orders(metadata))
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
    smearing = np.array(run["smearing"])  # (orders, windows)
    coarse = int(np.sum(np.any(smearing > COARSE, axis=0)))  # number of windows
    median = 20.0 * np.log10(1.0 + float(np.median(smearing)))
    smearing_text = f"median {number(median, 2)} dB"
    if coarse:
        smearing_text += f"; above 1 dB in {coarse} windows: run up more slowly"
    rows.append(("smearing by the windows", smearing_text))
    return tuple(rows)


def third_octaves_over_time(metadata: Json) -> Figure:
    """Draw the A-weighted bands over the run: impacts, sidebands and free vibration are among them."""
    course = metadata["over_time"]
    center = np.array(course["third_octave_hz"])
    level = np.array(course["third_octave_db"]) + a_weighting(center)[:, None]  # (bands, times)
    total = np.array(course["total_level_db_a"])
    time = np.array(course["time_s"])
    band = np.arange(center.size, dtype=float)
    loudest = int(total.argmax())
    x = Axis.over("time, s", time)
    names = tuple((float(k), f"{center[k]:g}") for k in range(0, center.size, 3))  # one label an octave
    y = Axis("nominal center of the band, Hz", limits=(-0.5, center.size - 0.5), names=names)
    return Figure(
        key="sound_over_time",
        title="Sound power in third octaves over the run",
        caption="All that the forces on the bearings hold, impacts and sidebands too, from "
        f"{number(course['lowest_hz'], 3)} to {number(course['highest_hz'], 4)} Hz; A-weighted at the "
        f"centers of bands. Blocks of {BLOCK:g} s overlap by half.",
        alternative=f"Loudest at {number(time[loudest], 3)} s: {total[loudest]:.1f} dB(A) in all.",
        content=(Panel(x, y, shade=shaded_levels(time, band, level, LABEL, DEPTH)),),
        table=_over_time_table(course),
    )


def _over_time_table(course: Json) -> Table:
    names = ("time_s", "speed_rpm", "total_level_db", "total_level_db_a")
    columns = {
        "time, s": lambda row: f"{row['time_s']:.3f}",
        "speed, rpm": lambda row: number(row["speed_rpm"], 5),
        "dB": lambda row: f"{row['total_level_db']:.1f}",
        "dB(A)": lambda row: f"{row['total_level_db_a']:.1f}",
    }
    values = zip(*(course[name] for name in names), strict=True)
    rows = [dict(zip(names, row, strict=True)) for row in values]
    return Table.of("Sound power over the run", rows, columns)


def total_line(speed: FloatArray, metadata: Json) -> tuple[FloatArray, FloatArray] | None:
    """Return the total level of a run over the axis of its orders: points on the axis, and levels in dB(A).

    Points rise. Returns None for a result without the sound over time.
    """
    course = metadata.get("over_time")
    if course is None:
        return None
    axis, _ = row_axis(speed, metadata)
    name = "time_s" if axis.label == "time, s" else "speed_rpm"
    point = np.array(course[name])
    rising = np.argsort(point, kind="stable")
    return point[rising], np.array(course["total_level_db_a"])[rising]
