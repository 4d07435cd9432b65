"""Page of a housing's vibration: velocities by order, contributions, transfer functions, shapes.

*Points* are those of the housing at which velocities are requested. Axes: S speeds, H orders. An analysis
shows one speed and one order in detail, `at_speed` and `at_order`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TypeVar

import numpy as np

from bounds.types import FloatArray, IntArray
from dynamics.vibration import VibrationAnalysis, vibration_level
from lineofaction.gearbox.studies.vibration.measured import MeasuredHousingVibration
from lineofaction.gearbox.studies.vibration.run import MM_PER_S, HousingVibrationResult, Result
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    Line,
    Panel,
    Reference,
    Table,
    category_lines,
    number,
)
from lineofaction.report.drawing.marks import drawn_orders, order_label
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.surface_view import shape_figure
from lineofaction.report.housing.forces import force_rows, row_axis
from lineofaction.report.housing.measured_vibration import (
    measured_figure,
    measured_page,
    measured_series,
    measured_text,
    where_text,
)
from lineofaction.report.housing.shares import share_panel, share_rows, velocity_text
from lineofaction.report.presentation import Presentation, dynamics_page, model_text
from lineofaction.report.response.excitations import excitation_figures, excitation_table

View = TypeVar("View")
_LARGEST_HEAD = (
    "velocity of", "order", "speed, rpm", "frequency, Hz", "nearest mode, Hz", "rms, mm/s",
    "level, dB re 1 nm/s", "within valid modes",
)  # fmt: skip
MAX_ORDERS, MAX_POINTS, MAX_SEATS = 6, 3, 4
"""Most orders in a panel, panels of points, and seats in a panel of transfer functions."""


def _largest_table(result: HousingVibrationResult) -> Table:
    """List the largest velocity of every point and of the outer hull, with the nearest mode."""
    vibration = result.analysis.vibration
    sizes = [(name, vibration.rms[k]) for k, name in enumerate(vibration.point)]
    if result.analysis.deflection is not None:
        sizes.append(("outer hull, normal", np.sqrt(vibration.mean_square_velocity)))
    rows = []
    for name, rms in sizes:
        s, h = map(int, np.unravel_index(int(np.argmax(rms)), rms.shape))
        hertz = float(vibration.frequency[s, h])
        near = result.natural_frequency[int(np.argmin(np.abs(result.natural_frequency - hertz)))]
        speed = number(float(vibration.speed[s]) / RPM, 5)
        order = order_label(vibration.order[h], result.analysis.metadata)
        size = number(float(rms[s, h]) / MM_PER_S, 4), number(float(vibration_level(rms[s, h])), 4)
        valid = "yes" if vibration.valid[s, h] else "no"
        rows.append((name, order, speed, number(hertz, 5), number(near, 5), *size, valid))
    return Table("Largest velocity of every point", _LARGEST_HEAD, tuple(rows))


def _contribution_table(result: HousingVibrationResult) -> Table:
    analysis = result.analysis
    head = ["part", "frequency, Hz", *(f"{point}, %" for point in analysis.vibration.point)]
    with_surface = analysis.deflection is not None
    rows = [*share_rows(analysis.bearings, with_surface), *share_rows(analysis.modes, with_surface)]
    if with_surface:
        head.append("outer hull, %")
    return Table(
        f"Contributions to the mean square velocity at {where_text(analysis)}", tuple(head), tuple(rows)
    )


def _series(result: HousingVibrationResult) -> Table:
    """Return every velocity: a row for each speed and order, rms along x, y, z in mm/s."""
    analysis = result.analysis
    vibration = analysis.vibration
    head = ["speed_rpm", "order", "frequency_hz", "valid"]
    head += [f"{name}_{axis}_mm_per_s" for name in vibration.point for axis in "xyz"]
    columns = [
        np.repeat(vibration.speed / RPM, vibration.order.size),
        np.tile(vibration.order, vibration.speed.size),
        vibration.frequency.ravel(),
        vibration.valid.ravel().astype(float),
        # rms of complex peak amplitudes; a column for each point and axis
        *(np.abs(vibration.velocity) / np.sqrt(2.0) / MM_PER_S).reshape(-1, vibration.frequency.size),
    ]
    if analysis.deflection is not None:
        head.append("surface_mm_per_s")
        columns.append(np.sqrt(vibration.mean_square_velocity).ravel() / MM_PER_S)
    rows = tuple(tuple(f"{value:.9g}" for value in row) for row in zip(*columns, strict=True))
    return Table("Velocities by speed and order", tuple(head), rows)


def _velocity_figure(result: HousingVibrationResult) -> Figure:
    analysis = result.analysis
    vibration = analysis.vibration
    size = {f"velocity of {name}": vibration.rms[k] for k, name in enumerate(vibration.point)}
    size = dict(sorted(size.items(), key=lambda pair: -float(pair[1].max()))[:MAX_POINTS])
    if analysis.deflection is not None:
        size["velocity normal to the outer hull"] = np.sqrt(vibration.mean_square_velocity)
    return Figure(
        key="housing_velocity",
        title=f"Vibration of {analysis.housing} by order",
        caption="Root mean square velocity under the forces of the bearings: of points all directions "
        "together, of the outer hull (no walls of cavities) its mean square normal to it. Dashed: above "
        f"{number(vibration.highest_valid_frequency, 4)} Hz, 0.7 of the highest mode kept.",
        alternative=_alternative(result),
        content=tuple(_velocity_panel(analysis, name, rms / MM_PER_S) for name, rms in size.items()),
        table=_largest_table(result),
    )


def _velocity_panel(analysis: VibrationAnalysis, name: str, rms: FloatArray) -> Panel:
    """Draw one velocity (S, H) in mm/s by its largest orders."""
    vibration = analysis.vibration
    x, speed = row_axis(vibration.speed, analysis.metadata)
    lines = []
    for k, h in enumerate(drawn_orders(vibration.order, rms.max(axis=0), MAX_ORDERS, analysis.metadata)):
        valid, color = vibration.valid[:, h], palette.category(k)
        order = f"order {order_label(vibration.order[h], analysis.metadata)}"
        lines.append(Line(order, speed, np.where(valid, rms[:, h], np.nan), color, width=1.4))
        if not np.all(valid):
            dashed = ~valid | np.append(~valid[1:], False)  # from the last valid speed on: no gap
            beyond = np.where(dashed, rms[:, h], np.nan)
            lines.append(Line(f"{order}, beyond", speed, beyond, color, "dash", 1.0))
    return Panel(x, Axis("rms velocity, mm/s"), tuple(lines), title=name)


def _transfer_figure(result: HousingVibrationResult) -> Figure:
    analysis = result.analysis
    mobilities = analysis.mobilities
    hertz, force = mobilities.frequency, analysis.vibration.seat_force[analysis.at_speed, analysis.at_order]
    x = Axis("frequency, Hz", limits=(0.0, float(hertz[-1])))
    at = float(analysis.vibration.frequency[analysis.at_speed, analysis.at_order])
    named = (("shown order", at), ("valid to", analysis.vibration.highest_valid_frequency))
    marks = tuple(Reference(name, value) for name, value in named if value <= hertz[-1])
    nearest = int(np.argmin(np.abs(hertz - at)))
    per_force = Axis("velocity per force, m/(N s)", "log")
    panels = []
    title = "surface"

    def curves(gain: FloatArray, seats: IntArray) -> tuple[Line, ...]:
        return category_lines(hertz, [mobilities.seat[s] for s in seats], gain.T[seats], width=1.2)

    if analysis.vibration.point:
        point, axis = _fastest(analysis)
        title = f"{analysis.vibration.point[point]} along {'xyz'[axis]}"
        gain = mobilities.point[point, axis]
        maximum = np.argsort(-np.abs(gain[nearest] * force), kind="stable")[:MAX_SEATS]
        panels.append(Panel(x, per_force, curves(np.abs(gain), maximum), marks, title=title))
        phase = curves(np.degrees(np.angle(gain)), maximum)
        panels.append(Panel(x, Axis("phase, °", limits=(-180.0, 180.0)), phase))
    if analysis.deflection is not None:
        gain = np.sqrt(mobilities.surface)
        maximum = np.argsort(-gain[nearest] * np.abs(force), kind="stable")[:MAX_SEATS]
        panels.append(Panel(x, per_force, curves(gain, maximum), title="root mean square of the outer hull"))
    return Figure(
        key="housing_transfer",
        title=f"Transfer functions of {analysis.housing}",
        caption="Velocity per force on a seat (per moment in N m for tilts), along the seat's own axes: the "
        "seats that act most in the order shown.",
        alternative=f"From the seats to {title}, up to {number(hertz[-1], 4)} Hz.",
        content=tuple(panels),
    )


def _fastest(analysis: VibrationAnalysis) -> tuple[int, int]:
    """Return the point and the axis of the largest velocity at the shown speed and order."""
    size = np.abs(analysis.vibration.velocity[:, :, analysis.at_speed, analysis.at_order])
    point, axis = np.unravel_index(int(np.argmax(size)), size.shape)
    return int(point), int(axis)


def _contribution_figure(result: HousingVibrationResult) -> Figure:
    analysis = result.analysis
    of_surface = analysis.deflection is not None
    point = 0 if of_surface else _fastest(analysis)[0]
    what = "of the outer hull" if of_surface else f"of {analysis.vibration.point[point]}"
    texts, panels = [], []
    for shares in (analysis.bearings, analysis.modes):
        part = shares.surface if of_surface else shares.point[point]
        largest = f"{number(100.0 * float(part.max()), 3)} %"
        texts.append(f"Most comes from {shares.name[int(np.argmax(part))]}, {largest}.")
        panels.append(share_panel(shares, part))
    return Figure(
        key="housing_contributions",
        title=f"Contributions to the mean square velocity {what}",
        caption=f"At {where_text(analysis)}. Bars of a panel add up to 100 %; below zero: against the sum.",
        alternative=" ".join(texts),
        content=tuple(panels),
        table=_contribution_table(result),
    )


def _shape_figure(result: HousingVibrationResult) -> Figure | None:
    """Draw the mode or the operating deflection from two sides; None without a surface."""
    shape = result.shape
    if shape is None:
        return None
    if result.mode:  # a mode has no unit
        what = f"Mode {result.mode}, {number(result.natural_frequency[result.mode - 1], 4)} Hz"
        return shape_figure("housing_shape", what, shape, None)
    what = f"Operating deflection at {where_text(result.analysis)}"
    return shape_figure("housing_shape", what, shape, (MM_PER_S, "mm/s"))


def _alternative(result: HousingVibrationResult) -> str:
    analysis, vibration = result.analysis, result.analysis.vibration
    beyond = vibration.order[~np.all(vibration.valid, axis=0)]
    text = f"Shown in detail: {where_text(analysis)}."
    if beyond.size:
        orders = ", ".join(order_label(order, analysis.metadata) for order in beyond[:MAX_ORDERS])
        text += f" Orders {orders} reach above what the modes kept carry."
    return text


def _page(result: HousingVibrationResult) -> Page:
    metadata = result.analysis.metadata
    drawn = [_velocity_figure(result), *filter(None, (_shape_figure(result),))]
    drawn += [_contribution_figure(result), _transfer_figure(result), *excitation_figures(metadata)]
    page = dynamics_page("Vibration of the housing", tuple(drawn), _headlines(result), metadata)
    forces = Table("Forces that move the housing", ("what", "how"), force_rows(metadata))
    accuracy = Section("Accuracy of the velocities", tables=(forces,), part=Part.ACCURACY)
    return replace(page, sections=(*page.sections, accuracy))


def _headlines(result: HousingVibrationResult) -> tuple[Headline, ...]:
    analysis = result.analysis
    vibration, at = analysis.vibration, (analysis.at_speed, analysis.at_order)
    surface = analysis.deflection is not None
    if vibration.point:
        rms = vibration.rms[(slice(None), *at)]
        fastest = int(np.argmax(rms))
        name = f"velocity of {vibration.point[fastest]}"
        first = Headline(name, velocity_text(float(rms[fastest])), where_text(analysis))
    else:
        rms_of_hull = float(vibration.mean_square_velocity[at]) ** 0.5
        first = Headline("velocity of the outer hull", velocity_text(rms_of_hull))
    maximum = []
    for what, shares in (("bearing", analysis.bearings), ("mode", analysis.modes)):
        part = shares.surface if surface else shares.point[0]
        p = int(np.argmax(part))
        hertz = f"{number(shares.frequency[p], 4)} Hz, " if np.isfinite(shares.frequency[p]) else ""
        share = f"{hertz}{number(100.0 * float(part[p]), 3)} % of the mean square"
        maximum.append(Headline(f"{what} that contributes most", shares.name[p], share))
    return (first, *maximum)


def _text(result: HousingVibrationResult) -> Iterator[Table | str]:
    analysis, vibration = result.analysis, result.analysis.vibration
    yield _largest_table(result)
    yield _contribution_table(result)
    yield from filter(None, (excitation_table(analysis.metadata),))
    beyond = vibration.order[~np.all(vibration.valid, axis=0)]
    if beyond.size:
        orders = ", ".join(order_label(order, analysis.metadata) for order in beyond)
        limit = number(vibration.highest_valid_frequency, 4)
        yield f"orders {orders} go beyond {limit} Hz, 0.7 of the highest mode kept: keep more modes"
    yield from (f"{what}: {text}" for what, text in force_rows(analysis.metadata))
    yield from model_text(analysis.metadata)


def _by_kind(
    modeled: Callable[[HousingVibrationResult], View], measured: Callable[[MeasuredHousingVibration], View]
) -> Callable[[Result], View]:
    """Return a function that shows a result by the kind of its housing."""

    def rendered(result: Result) -> View:
        return measured(result) if isinstance(result, MeasuredHousingVibration) else modeled(result)

    return rendered


PAGE = Presentation(
    _by_kind(lambda result: _shape_figure(result) or _velocity_figure(result), measured_figure),
    _by_kind(_page, measured_page),
    _by_kind(_text, measured_text),
    series=_by_kind(_series, measured_series),
)
