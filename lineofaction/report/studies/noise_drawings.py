"""Figures of a radiated sound."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.acoustics import OrderPower, a_weighting, sound_power_level
from dynamics.noise import RadiatedSound
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, HeatMap, Line, Panel, Table, number
from lineofaction.report.drawing.surface_view import surface_panels
from lineofaction.report.studies.bearing_force_words import of_run, row_axis
from lineofaction.report.studies.noise_over_time import total_line

RPM = np.pi / 30.0
DEPTH = 60.0
"""dB shown below the loudest."""
LINES, SHOWN = 160, 6
"""Cells of the map in frequency; lines of orders and bearings."""


def sound_map(sound: RadiatedSound, table: Table, words: Sequence[str]) -> Figure:
    """Draw the A-weighted level over speed and frequency."""
    orders, (x, along) = sound.orders, row_axis(sound.speed, sound.facts)
    forces = "linear: mean mesh stiffness, no loss of contact"
    if of_run(sound.facts) is not None:
        forces = "with the amplitudes of the run"
    return Figure(
        key="sound_map",
        title="Sound power over speed and frequency",
        caption="A-weighted sound power level re 1 pW of each order as in a steady state, "
        f"{forces}. Colors end {DEPTH:g} dB below the loudest.",
        alternative=" ".join(f"Loudest: {text}." for text in words) or "Nothing radiates.",
        content=(Panel(x, Axis("frequency, Hz"), shade=_cells(orders, along)),),
        table=table,
    )


def _cells(orders: OrderPower, speed: FloatArray) -> HeatMap:
    """Add up the orders in cells of speed and frequency, up to the highest that is shown.

    They are tall enough that lines of orders are not broken.
    """
    top, steps = float(orders.frequency.max()), np.abs(np.diff(orders.frequency, axis=1))
    height = max(top / LINES, float(steps.max(initial=0.0)))
    edges = np.arange(0.0, top + 2.0 * height, height)
    cell = np.digitize(orders.frequency, edges) - 1
    power = np.zeros((edges.size - 1, speed.size))
    np.add.at(power, (cell, np.broadcast_to(np.arange(speed.size), cell.shape)), orders.weighted_power)
    level = sound_power_level(power)
    most = float(level.max())
    z = np.where(level < most - DEPTH, np.nan, level)
    shown = int(np.flatnonzero(np.any(level >= most - DEPTH, axis=1)).max(initial=0)) + 1
    middle = 0.5 * (edges[1:] + edges[:-1])
    return HeatMap(speed, middle[:shown], z[:shown], "sound power level, dB(A)", most, most - DEPTH)


def level_over_speed(sound: RadiatedSound) -> Figure:
    """Draw the total and the loudest orders over speed."""
    orders, (x, speed) = sound.orders, row_axis(sound.speed, sound.facts)
    level, total = orders.weighted_level, orders.total_weighted_level
    shown = sorted(int(k) for k in np.argsort(-level.max(axis=1), kind="stable")[:SHOWN])
    floor = float(total.max()) - DEPTH
    lines = (
        Line("total", speed, _above(total, floor), palette.INK, width=2.2),
        *(
            Line(f"order {order:.4g}", speed, _above(level[h], floor), palette.category(k), width=1.4)
            for k, (h, order) in enumerate(zip(shown, sound.order[shown], strict=True))
        ),
    )
    if (whole := total_line(sound.speed, sound.facts)) is not None:
        lines += (Line("all of the run", whole[0], _above(whole[1], floor), palette.MUTED, width=1.4),)
    at = int(total.argmax())
    return Figure(
        key="sound_levels",
        title="Sound power of the orders over speed",
        caption=f"Orders add up in power. The {SHOWN} loudest are shown.",
        alternative=f"The total is largest at {_rpm(sound, at)}: {total[at]:.1f} dB(A).",
        content=(Panel(x, Axis("sound power level, dB(A)"), lines),),
        table=_levels_table(sound, level, total),
    )


def third_octaves(sound: RadiatedSound) -> Figure:
    """Draw the levels of the bands: at the loudest speed, and the largest over all speeds."""
    center, power = sound.orders.third_octaves()
    weighting = a_weighting(center)[:, None]
    level = sound_power_level(power) + weighting
    at = int(sound.orders.total_weighted_level.argmax())
    floor = float(level.max()) - DEPTH
    edges = np.append(center, center[-1] * 10.0**0.1) * 10.0**-0.05
    speed = number(float(sound.speed[at]) / RPM, 4)
    lines = tuple(
        Line(name, np.repeat(edges, 2)[1:-1], np.repeat(np.maximum(values, floor), 2), color)
        for name, values, color in (
            ("largest over speed", level.max(axis=1), palette.BLUE),
            (f"at {speed} rpm, the loudest speed", level[:, at], palette.VERMILLION),
        )
    )
    worst = int(level.max(axis=1).argmax())
    names = tuple((float(value), f"{value:g}") for value in center[:: max(center.size // 8, 1)])
    x = Axis("nominal center of the band, Hz", "log", (float(edges[0]), float(edges[-1])), names)
    rows = zip(center, level.max(axis=1), level[:, at], strict=True)
    return Figure(
        key="sound_third_octaves",
        title="Sound power in third octaves",
        caption="A band takes all of an order whose frequency lies in it (IEC 61260-1); A-weighting is that "
        "of the nominal center.",
        alternative=f"The loudest band is that at {center[worst]:g} Hz: {level[worst].max():.1f} dB(A).",
        content=(Panel(x, Axis("sound power level, dB(A)"), lines),),
        table=Table(
            "Third octaves",
            ("band, Hz", "largest over speed, dB(A)", f"at {speed} rpm, dB(A)"),
            tuple((f"{f:g}", f"{a:.1f}", f"{b:.1f}") for f, a, b in rows),
        ),
    )


def bearing_levels(sound: RadiatedSound) -> Figure:
    """Draw what the force of each bearing would radiate alone."""
    (x, speed), total = row_axis(sound.speed, sound.facts), sound.orders.total_weighted_level
    alone = np.stack([_total(sound, power) for power in sound.bearing_alone])
    floor = float(total.max()) - DEPTH
    most = np.argsort(-alone.max(axis=1), kind="stable")[:SHOWN]
    lines = (
        Line("all", speed, _above(total, floor), palette.INK, width=2.2),
        *(
            Line(sound.bearing[b], speed, _above(alone[b], floor), palette.category(k), width=1.4)
            for k, b in enumerate(most)
        ),
    )
    at = int(total.argmax())
    loud = int(alone[:, at].argmax())
    without = np.stack([_total(sound, power) for power in sound.without_bearing])
    return Figure(
        key="sound_bearings",
        title="Sound power by the force of each bearing alone",
        caption="Forces of bearings are coherent: their powers do not add up, and one may be louder alone "
        "than all together.",
        alternative=f"At {_rpm(sound, at)} bearing {sound.bearing[loud]} alone radiates "
        f"{alone[loud, at]:.1f} dB(A) of {total[at]:.1f} dB(A).",
        content=(Panel(x, Axis("sound power level, dB(A)"), lines),),
        table=Table(
            f"Bearings at {_rpm(sound, at)}",
            ("bearing", "alone, dB(A)", "all without it, dB(A)"),
            tuple(
                (name, f"{alone[b, at]:.1f}", f"{without[b, at]:.1f}") for b, name in enumerate(sound.bearing)
            ),
        ),
    )


def panel_intensity(sound: RadiatedSound, where: str, table: Table) -> Figure | None:
    """Draw the intensity on the hulls at the loudest point, `where`; None where it was not looked at."""
    panels = sound.panels
    if panels is None:
        return None
    hull, value = panels.hull, 1e3 * panels.intensity
    least, largest = (number(float(end), 2) for end in (value.min(), value.max()))
    return Figure(
        key="sound_panels",
        title=f"Sound intensity on the surface: {where}",
        caption="Active intensity normal to the hull that the radiation model takes: openings are covered, "
        "fine details rounded off. Negative: takes power that other panels radiate.",
        alternative=f"The intensity is between {least} and {largest} mW/m².",
        content=surface_panels(
            hull.nodes, hull.triangles, np.zeros_like(hull.nodes), value, "intensity, mW/m²", "outer hull"
        ),
        table=table,
    )


def _total(sound: RadiatedSound, power: FloatArray) -> FloatArray:
    """Return the A-weighted level of all orders of a power (S, H), (S,), dB(A)."""
    return OrderPower(sound.frequency.T, np.maximum(power.T, 0.0)).total_weighted_level


def _levels_table(sound: RadiatedSound, level: FloatArray, total: FloatArray) -> Table:
    """Where the total and each order are loudest."""
    rows = [("total", f"{total.max():.1f}", number(float(sound.speed[total.argmax()]) / RPM, 5), "")]
    for h, order in enumerate(sound.order):
        at = int(level[h].argmax())
        speed = number(float(sound.speed[at]) / RPM, 5)
        rows.append((f"{order:.4g}", f"{level[h, at]:.1f}", speed, number(float(sound.frequency[at, h]), 5)))
    head = ("order", "dB(A)", "speed, rpm", "frequency, Hz")
    return Table("Largest level of each order", head, tuple(rows))


def _rpm(sound: RadiatedSound, row: int) -> str:
    return f"{number(float(sound.speed[row]) / RPM, 4)} rpm"


def _above(level: FloatArray, floor: float) -> FloatArray:
    return np.where(level < floor, np.nan, level)
