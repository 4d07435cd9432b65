"""Page of the vibration of a measured housing: velocities, shares of bearings, missing functions.

Axes of arrays: S speeds, H orders.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bounds.types import FloatArray
from dynamics.vibration import VibrationAnalysis, vibration_level
from lineofaction.gearbox.studies.vibration.measured import MeasuredHousingVibration
from lineofaction.gearbox.studies.vibration.run import MM_PER_S
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Table, number
from lineofaction.report.drawing.marks import drawn_orders, order_label, words_of_order
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.housing.forces import force_rows, row_axis
from lineofaction.report.housing.shares import share_panel, share_rows, velocity_text
from lineofaction.report.presentation import dynamics_page, model_text
from lineofaction.report.response.excitations import excitation_figures, excitation_table

MAX_ORDERS, MAX_POINTS = 6, 3
_LARGEST_HEAD = (
    "velocity of", "order", "speed, rpm", "frequency, Hz", "rms, mm/s", "level, dB re 1 nm/s",
    "measured along",
)  # fmt: skip
_OMITTED = "What the measured responses replace and leave out"


def measured_figure(result: MeasuredHousingVibration) -> Figure:
    """Draw the velocities of the points by their largest orders; nothing outside the measured band."""
    vibration = result.vibration
    largest = np.nanmax(vibration.rms, axis=(1, 2))
    fastest = np.argsort(-largest, kind="stable")[:MAX_POINTS]
    band = f"{number(result.lowest_frequency, 4)} to {number(result.highest_frequency, 4)} Hz"
    return Figure(
        key="housing_velocity",
        title=f"Vibration of {result.housing} by order, by measured responses",
        caption="Root mean square velocity of points under the forces of the bearings, the measured "
        f"directions together. Nothing is drawn outside the measured band, {band}.",
        alternative=f"Shown in detail: {where_text(result)}.",
        content=tuple(_panel(result, vibration.point[k], vibration.rms[k] / MM_PER_S) for k in fastest),
        table=_largest_table(result),
    )


def _panel(result: MeasuredHousingVibration, name: str, rms: FloatArray) -> Panel:
    """Draw one velocity (S, H) in mm/s by its largest orders."""
    vibration = result.vibration
    x, along = row_axis(vibration.speed, result.metadata)
    sizes = np.nan_to_num(rms).max(axis=0)
    lines = []
    for k, h in enumerate(drawn_orders(vibration.order, sizes, MAX_ORDERS, result.metadata)):
        order = f"order {order_label(vibration.order[h], result.metadata)}"
        lines.append(Line(order, along, rms[:, h], palette.category(k), width=1.4))
    return Panel(x, Axis("rms velocity, mm/s"), tuple(lines), title=name)


def where_text(result: MeasuredHousingVibration | VibrationAnalysis) -> str:
    """Return the order, the speed and the frequency that are shown in detail, as text."""
    vibration, s, h = result.vibration, result.at_speed, result.at_order
    speed, hertz = number(float(vibration.speed[s]) / RPM, 4), number(vibration.frequency[s, h], 4)
    return f"{words_of_order(vibration.order[h], result.metadata)}, at {speed} rpm, {hertz} Hz"


def _largest_table(result: MeasuredHousingVibration) -> Table:
    """List the largest velocity of every point inside the measured band."""
    vibration, axes = result.vibration, result.axes
    rows = []
    for name, rms in zip(vibration.point, vibration.rms, strict=True):
        s, h = map(int, np.unravel_index(int(np.nanargmax(rms)), rms.shape))
        order = order_label(vibration.order[h], result.metadata)
        speed, hertz = float(vibration.speed[s]) / RPM, float(vibration.frequency[s, h])
        size = number(float(rms[s, h]) / MM_PER_S, 4), number(float(vibration_level(rms[s, h])), 4)
        rows.append((name, order, number(speed, 5), number(hertz, 5), *size, ", ".join(axes[name])))
    return Table("Largest velocity of every point", _LARGEST_HEAD, tuple(rows))


def _contribution_table(result: MeasuredHousingVibration) -> Table:
    head = ("part", "frequency, Hz", *(f"{point}, %" for point in result.vibration.point))
    caption = f"Contributions to the mean square velocity at {where_text(result)}"
    return Table(caption, head, tuple(share_rows(result.bearing_shares, with_surface=False)))


def _fastest(result: MeasuredHousingVibration) -> int:
    return int(np.argmax(result.vibration.rms[:, result.at_speed, result.at_order]))


def _contribution_figure(result: MeasuredHousingVibration) -> Figure | None:
    """Draw the contributions of bearings to the fastest point; None: all points are at rest."""
    point, shares = _fastest(result), result.bearing_shares
    part = shares.point[point]
    if not np.all(np.isfinite(part)):
        return None
    maximum = int(np.argmax(part))
    return Figure(
        key="housing_contributions",
        title=f"Contributions to the mean square velocity of {result.vibration.point[point]}",
        caption=f"At {where_text(result)}. Bars add up to 100 %; below zero: against the sum.",
        alternative=f"Most comes from {shares.name[maximum]}, {number(100.0 * float(part[maximum]), 3)} %.",
        content=(share_panel(shares, part),),
        table=_contribution_table(result),
    )


def measured_page(result: MeasuredHousingVibration) -> Page:
    """Return the page of a measured housing, with a table of parts that its responses replace or omit."""
    contributions = _contribution_figure(result)
    drawn = [measured_figure(result)]
    if contributions is not None:
        drawn.append(contributions)
    drawn += excitation_figures(result.metadata)
    page = dynamics_page("Vibration of the housing", tuple(drawn), _headlines(result), result.metadata)
    rests = Table("Forces that move the housing", ("what", "how"), force_rows(result.metadata))
    absent = Table(_OMITTED, (result.file,), tuple((sentence,) for sentence in result.left_out))
    accuracy = Section("Accuracy of the velocities", tables=(absent, rests), part=Part.ACCURACY)
    return replace(page, sections=(*page.sections, accuracy))


def _headlines(result: MeasuredHousingVibration) -> tuple[Headline, ...]:
    vibration, point = result.vibration, _fastest(result)
    rms = float(vibration.rms[point, result.at_speed, result.at_order])
    first = Headline(f"velocity of {vibration.point[point]}", velocity_text(rms), where_text(result))
    part = result.share[:, point]
    if not np.all(np.isfinite(part)):
        return (first,)
    maximum = int(np.argmax(part))
    share = f"{number(100.0 * float(part[maximum]), 3)} % of the mean square"
    return first, Headline("bearing that contributes most", result.bearing[maximum], share)


def measured_text(result: MeasuredHousingVibration) -> Iterator[Table | str]:
    """Yield velocities, contributions, excitations, and sentences on missing parts."""
    yield _largest_table(result)
    yield _contribution_table(result)
    yield from filter(None, (excitation_table(result.metadata),))
    yield from result.left_out
    yield from (f"{what}: {text}" for what, text in force_rows(result.metadata))
    yield from model_text(result.metadata)


def measured_series(result: MeasuredHousingVibration) -> Table:
    """Return the velocities, rms along the measured axes in mm/s; empty outside the measured band."""
    vibration = result.vibration
    size = np.abs(vibration.velocity) / np.sqrt(2.0) / MM_PER_S
    directions = [(part.name, part.axis) for part in result.response]
    head = ["speed_rpm", "order", "frequency_hz", "valid"]
    head += [f"{name}_{'xyz'[axis]}_mm_per_s" for name, axis in directions]
    columns = [
        np.repeat(vibration.speed / RPM, vibration.order.size),
        np.tile(vibration.order, vibration.speed.size),
        vibration.frequency.ravel(),
        vibration.covered.ravel().astype(float),
        *(size[vibration.point.index(name), axis].ravel() for name, axis in directions),
    ]
    rows = []
    for row in zip(*columns, strict=True):
        rows.append(tuple(f"{value:.9g}" if np.isfinite(value) else "" for value in row))
    return Table("Velocities by speed and order", tuple(head), tuple(rows))
