"""A housing's vibration as people see it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bounds.types import FloatArray
from dynamics.vibration import VibrationAnalysis, vibration_level
from dynamics.vibration.vibration_analysis import Shares
from lineofaction.gearbox.convert.effects import model_lines
from lineofaction.gearbox.studies.vibration.run import MM_PER_S, HousingVibrationResult
from lineofaction.gearbox.units import MM, RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Figure, Line, Panel, Reference, Table, number
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.surface_view import surface_panels
from lineofaction.report.drawing.tables import cost_tables
from lineofaction.report.presentation import Presentation, dynamics_page
from lineofaction.report.studies.noise_over_time import force_words, row_axis

# Tables of a housing's vibration.


SHOWN = 12
"""Modes in the table of contributions."""


def where(found: VibrationAnalysis) -> str:
    """Say the order, speed and frequency looked at."""
    vibration, s, h = found.vibration, found.at_speed, found.at_order
    speed, hertz = number(float(vibration.speed[s]) / RPM, 4), number(float(vibration.frequency[s, h]), 4)
    return f"order {vibration.order[h]:.4g} at {speed} rpm, {hertz} Hz"


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
        rows.append(
            (
                name,
                f"{vibration.order[h]:.4g}",
                number(float(vibration.speed[s]) / RPM, 5),
                number(hertz, 5),
                number(float(near), 5),
                number(float(rms[s, h]) / MM_PER_S, 4),
                number(float(vibration_level(rms[s, h])), 4),
                "yes" if vibration.valid[s, h] else "no",
            )
        )
    head = ["velocity of", "order", "speed, rpm", "frequency, Hz", "nearest mode, Hz"]
    head += ["rms, mm/s", "level, dB re 1 nm/s", "within valid modes"]
    return Table("Largest velocity of every point", tuple(head), tuple(rows))


def _contribution_table(result: HousingVibrationResult) -> Table:
    """List the contributions of bearings and of the largest modes."""
    found = result.analysis
    head = ["part", "frequency, Hz", *(f"{point}, %" for point in found.vibration.point)]
    with_surface = found.deflection is not None
    rows = [*_rows(found.bearings, with_surface), *_rows(found.modes, with_surface)]
    if with_surface:
        head.append("outer hull, %")
    return Table(f"Contributions to the mean square velocity at {where(found)}", tuple(head), tuple(rows))


def _rows(shares: Shares, with_surface: bool) -> list[tuple[str, ...]]:
    """Return rows of the largest parts, in their order."""
    every = np.vstack([shares.point, shares.surface]) if with_surface else shares.point
    most = np.sort(np.argsort(-np.max(np.abs(every), axis=0), kind="stable")[:SHOWN])
    return [
        (
            shares.name[p],
            number(float(shares.frequency[p]), 5) if np.isfinite(shares.frequency[p]) else "",
            *(f"{100.0 * float(value):.1f}" for value in every[:, p]),
        )
        for p in most
    ]


def series(result: HousingVibrationResult) -> Table:
    """Return every velocity: a row for each speed and order, rms along x, y, z in mm/s."""
    found = result.analysis
    vibration = found.vibration
    head = ["speed_rpm", "order", "frequency_hz", "valid"]
    head += [f"{name}_{axis}_mm_per_s" for name in vibration.point for axis in "xyz"]
    columns = [
        np.repeat(vibration.speed / RPM, vibration.order.size),
        np.tile(vibration.order, vibration.speed.size),
        vibration.frequency.ravel(),
        vibration.valid.ravel().astype(float),
        *(np.abs(vibration.velocity) / np.sqrt(2.0) / MM_PER_S).reshape(-1, vibration.frequency.size),
    ]
    if found.deflection is not None:
        head.append("surface_mm_per_s")
        columns.append(np.sqrt(vibration.mean_square_velocity).ravel() / MM_PER_S)
    rows = tuple(tuple(f"{value:.9g}" for value in row) for row in zip(*columns, strict=True))
    return Table("Velocities by speed and order", tuple(head), rows)


# Plots of a housing's vibration: velocities, transfer functions, contributions, shapes.


SHOWN_ORDERS, SHOWN_POINTS, SHOWN_SEATS, SHOWN_MODES = 6, 3, 4, 8
DRAWN = 0.06
"""Largest motion as it is drawn, over the size of the housing."""


def _velocity_figure(result: HousingVibrationResult) -> Figure:
    """Draw the velocities of the fastest points and of the surface by order over speed."""
    found = result.analysis
    vibration = found.vibration
    size = {f"velocity of {name}": vibration.rms[k] for k, name in enumerate(vibration.point)}
    size = dict(sorted(size.items(), key=lambda pair: -float(pair[1].max()))[:SHOWN_POINTS])
    if found.deflection is not None:
        size["velocity normal to the outer hull"] = np.sqrt(vibration.mean_square_velocity)
    return Figure(
        key="housing_velocity",
        title=f"Vibration of {found.housing} by order",
        caption="Root mean square velocity under the forces of the bearings: of points all directions "
        "together, of the outer hull (no walls of cavities) its mean square normal to it. Dashed: above "
        f"{number(vibration.highest_valid_frequency, 4)} Hz, 0.7 of the highest mode kept.",
        alternative=_words(result),
        content=tuple(_velocity_panel(found, name, rms / MM_PER_S) for name, rms in size.items()),
        table=_largest_table(result),
    )


def _velocity_panel(found: VibrationAnalysis, name: str, rms: FloatArray) -> Panel:
    """Draw one velocity (S, H) in mm/s by its largest orders."""
    vibration = found.vibration
    x, speed = row_axis(vibration.speed, found.facts)
    most = sorted(np.argsort(-rms.max(axis=0), kind="stable")[:SHOWN_ORDERS].tolist())
    lines = []
    for k, h in enumerate(most):
        valid, color, order = vibration.valid[:, h], palette.category(k), f"order {vibration.order[h]:.4g}"
        lines.append(Line(order, speed, np.where(valid, rms[:, h], np.nan), color, width=1.4))
        if not np.all(valid):
            onward = ~valid | np.append(~valid[1:], False)
            beyond = np.where(onward, rms[:, h], np.nan)
            lines.append(Line(f"{order}, beyond", speed, beyond, color, "dash", 1.0))
    return Panel(x, Axis("rms velocity, mm/s"), tuple(lines), title=name)


def _transfer_figure(result: HousingVibrationResult) -> Figure:
    """Draw the transfer functions from the seats that act most to the fastest point, and to the surface."""
    found = result.analysis
    mobilities = found.mobilities
    hertz, force = mobilities.frequency, found.vibration.seat_force[found.at_speed, found.at_order]
    x = Axis("frequency, Hz", limits=(0.0, float(hertz[-1])))
    at = float(found.vibration.frequency[found.at_speed, found.at_order])
    named = (("shown order", at), ("valid to", found.vibration.highest_valid_frequency))
    marks = tuple(Reference(name, value) for name, value in named if value <= hertz[-1])
    nearest = int(np.argmin(np.abs(hertz - at)))
    panels, title = [], "surface"
    if found.vibration.point:
        point, axis = _fastest(found)
        title = f"{found.vibration.point[point]} along {'xyz'[axis]}"
        gain = mobilities.point[point, axis]
        most = np.argsort(-np.abs(gain[nearest] * force), kind="stable")[:SHOWN_SEATS]
        sizes = [_line(mobilities.seat[s], hertz, np.abs(gain[:, s]), k) for k, s in enumerate(most)]
        turns = [
            _line(mobilities.seat[s], hertz, np.degrees(np.angle(gain[:, s])), k) for k, s in enumerate(most)
        ]
        panels.append(Panel(x, Axis("velocity per force, m/(N s)", "log"), tuple(sizes), marks, title=title))
        panels.append(Panel(x, Axis("phase, °", limits=(-180.0, 180.0)), tuple(turns)))
    if found.deflection is not None:
        gain = np.sqrt(mobilities.surface)
        most = np.argsort(-gain[nearest] * np.abs(force), kind="stable")[:SHOWN_SEATS]
        lines = [_line(mobilities.seat[s], hertz, gain[:, s], k) for k, s in enumerate(most)]
        label = Axis("velocity per force, m/(N s)", "log")
        panels.append(Panel(x, label, tuple(lines), title="root mean square of the outer hull"))
    return Figure(
        key="housing_transfer",
        title=f"Transfer functions of {found.housing}",
        caption="Velocity per force on a seat (per moment in N m for tilts), along the seat's own axes: the "
        "seats that act most in the order shown.",
        alternative=f"From the seats to {title}, up to {number(float(hertz[-1]), 4)} Hz.",
        content=tuple(panels),
    )


def _fastest(found: VibrationAnalysis) -> tuple[int, int]:
    """Return the point and the direction of the largest velocity at the order and speed shown."""
    size = np.abs(found.vibration.velocity[:, :, found.at_speed, found.at_order])
    point, axis = np.unravel_index(int(np.argmax(size)), size.shape)
    return int(point), int(axis)


def _line(name: str, x: FloatArray, y: FloatArray, color: int) -> Line:
    return Line(name, x, np.asarray(y, dtype=np.float64), palette.category(color), width=1.2)


def _contribution_figure(result: HousingVibrationResult) -> Figure:
    """Draw the contributions of bearings and of the largest modes."""
    found = result.analysis
    of_surface = found.deflection is not None
    point = 0 if of_surface else _fastest(found)[0]
    what = "of the outer hull" if of_surface else f"of {found.vibration.point[point]}"
    both = [(shares, shares.surface if of_surface else shares.point[point]) for shares in _both(found)]
    return Figure(
        key="housing_contributions",
        title=f"Contributions to the mean square velocity {what}",
        caption=f"At {where(found)}. Bars of a panel add up to 100 %; below zero: against the sum.",
        alternative=" ".join(
            f"Most comes from {shares.name[int(np.argmax(part))]}, {number(100.0 * float(part.max()), 3)} %."
            for shares, part in both
        ),
        content=tuple(_share_panel(*each) for each in both),
        table=_contribution_table(result),
    )


def _both(found: VibrationAnalysis) -> tuple[Shares, Shares]:
    return found.bearings, found.modes


def _share_panel(shares: Shares, part: FloatArray) -> Panel:
    """Draw the largest contributions, the rest together."""
    most = sorted(np.argsort(-np.abs(part), kind="stable")[:SHOWN_MODES].tolist())
    values = [100.0 * float(part[p]) for p in most]
    names = [_name(shares, p) for p in most]
    if len(most) < part.size:
        names.append("others")
        values.append(100.0 - sum(values))
    x = np.arange(len(names), dtype=float)
    bars = Bars("contribution", x, np.array(values), 0.0, 0.6, palette.BLUE)
    axis = Axis("", limits=(-0.6, len(names) - 0.4), names=tuple(zip(x.tolist(), names, strict=True)))
    return Panel(axis, Axis("contribution, %"), bars=(bars,))


def _name(shares: Shares, index: int) -> str:
    """Name a part: a mode by its frequency."""
    hertz = float(shares.frequency[index])
    return f"{number(hertz, 4)} Hz" if np.isfinite(hertz) else shares.name[index]


def _shape_figure(result: HousingVibrationResult) -> Figure | None:
    """Draw the mode or the operating deflection from two sides; None without a surface."""
    shape = result.shape
    if shape is None:
        return None
    if result.mode:
        what = f"Mode {result.mode}, {number(float(result.natural_frequency[result.mode - 1]), 4)} Hz"
        one, unit = 1.0, "1"
    else:
        what = f"Operating deflection at {where(result.analysis)}"
        one, unit = MM_PER_S, "mm/s"
    fastest = float(np.linalg.norm(shape.motion, axis=1).max())
    drawn = DRAWN * float(np.ptp(shape.points, axis=0).max())
    turned = shape.motion * np.exp(-0.5j * np.angle(np.sum(shape.motion**2)))  # as much as can be is real
    offset = drawn / max(fastest, 1e-300) * turned.real
    scale = f"{number(fastest / one, 3)} {unit} drawn as {number(drawn / MM, 3)} mm"
    label, value = f"normal to the surface, {unit}", np.abs(shape.normal_motion) / one
    return Figure(
        key="housing_shape",
        title=what,
        caption="Colors: peak amplitude normal to the surface. Drawn: the motion at the instant at which it "
        "is largest. Lines: edges at rest.",
        alternative=f"{what}: the largest motion is {number(fastest / one, 3)} {unit}.",
        content=surface_panels(shape.points, shape.facets, offset, value, label, scale),
    )


def _words(result: HousingVibrationResult) -> str:
    """Say what is fastest, and what holds no more."""
    found, vibration = result.analysis, result.analysis.vibration
    beyond = vibration.order[~np.all(vibration.valid, axis=0)]
    text = f"Shown in detail: {where(found)}."
    if beyond.size:
        orders = ", ".join(f"{order:.4g}" for order in beyond[:SHOWN_ORDERS])
        text += f" Orders {orders} reach above what the modes kept carry."
    return text


def figure(result: HousingVibrationResult) -> Figure:
    """Draw the mode or the deflection; without a surface the velocities."""
    return _shape_figure(result) or _velocity_figure(result)


def page(result: HousingVibrationResult) -> Page:
    """Return the report."""
    shape = _shape_figure(result)
    figures = (_velocity_figure(result), _contribution_figure(result), _transfer_figure(result))
    drawn = figures if shape is None else (figures[0], shape, *figures[1:])
    whole = dynamics_page("Vibration of the housing", drawn, headlines(result), result.analysis.facts)
    rests = Table("Forces that move the housing", ("what", "how"), force_words(result.analysis.facts))
    accuracy = Section("Accuracy of the velocities", tables=(rests,), part=Part.ACCURACY)
    return replace(whole, sections=(*whole.sections, accuracy))


def headlines(result: HousingVibrationResult) -> tuple[Headline, ...]:
    """Return the velocity at the order and speed shown, and what makes most of it."""
    found = result.analysis
    vibration, at = found.vibration, (found.at_speed, found.at_order)
    surface = found.deflection is not None
    if vibration.point:
        rms = vibration.rms[(slice(None), *at)]
        fastest = int(np.argmax(rms))
        first = Headline(f"velocity of {vibration.point[fastest]}", _speed(float(rms[fastest])), where(found))
    else:
        rms_of_hull = float(vibration.mean_square_velocity[at]) ** 0.5
        first = Headline("velocity of the outer hull", _speed(rms_of_hull))
    most = []
    for what, shares in (("bearing", found.bearings), ("mode", found.modes)):
        part = shares.surface if surface else shares.point[0]
        p = int(np.argmax(part))
        hertz = f"{number(float(shares.frequency[p]), 4)} Hz, " if np.isfinite(shares.frequency[p]) else ""
        share = f"{hertz}{number(100.0 * float(part[p]), 3)} % of the mean square"
        most.append(Headline(f"{what} that contributes most", shares.name[p], share))
    return (first, *most)


def _speed(rms: float) -> str:
    return f"{number(rms / MM_PER_S, 3)} mm/s rms"


def _text(result: HousingVibrationResult) -> Iterator[Table | str]:
    """Yield the largest velocities, the contributions, what holds no more, and the cost."""
    found, vibration = result.analysis, result.analysis.vibration
    yield _largest_table(result)
    yield _contribution_table(result)
    beyond = vibration.order[~np.all(vibration.valid, axis=0)]
    if beyond.size:
        orders = ", ".join(f"{order:.4g}" for order in beyond)
        limit = number(vibration.highest_valid_frequency, 4)
        yield f"orders {orders} go beyond {limit} Hz, 0.7 of the highest mode kept: keep more modes"
    yield from (f"{what}: {words}" for what, words in force_words(found.facts))
    yield from cost_tables(found.facts)
    yield from model_lines(found.facts)


PAGE = Presentation(figure, page, _text, series=series)
