"""Quietest flanks of a scene: levels before and after by load case, and figures that get worse."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bounds import engineering
from bounds.error_digits import error_text, to_error
from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.studies.optimize.result import HeardOptimization
from lineofaction.gearbox.units import RPM, UM, factor
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Figure, Panel, Table, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation

_WIDTH = 0.32
"""Width of a bar, two of which stand at an order."""


def _loads(result: HeardOptimization) -> tuple[str, ...]:
    return tuple(f"{torque:.4g} N m" for torque in result.torque)


def _counted(result: HeardOptimization) -> str:
    """Return the speeds and loads over which the minimized level counts, in words."""
    speeds, loads = result.speed / RPM, result.torque
    at_speed = f"at {speeds[0]:.4g} rpm"
    if speeds.size > 1:
        over = result.over_speeds.replace("_", " ")
        at_speed = f"{over} over {speeds.size} speeds from {speeds.min():.4g} to {speeds.max():.4g} rpm"
    at_load = f"at {loads[0]:.4g} N m"
    if loads.size > 1:
        over = result.over_loads.replace("_", " ")
        at_load = f"{over} over {loads.size} loads from {loads.min():.4g} to {loads.max():.4g} N m"
    return f"{result.quantity.replace('_', ' ')}, {at_speed}, {at_load}"


def _levels_figure(result: HeardOptimization) -> Figure:
    over = result.over_speeds.replace("_", " ")
    return Figure(
        key="heard",
        title="Levels before and after optimization",
        caption=f"{result.quantity.replace('_', ' ').capitalize()} by order, {over} over the speeds; from "
        "bottom to top of the pale bars by their errors.",
        alternative=result.reason,
        content=tuple(_panel(result, load) for load in range(result.torque.size)),
        table=_levels_table(result),
    )


def _panel(result: HeardOptimization, load: int) -> Panel:
    line = np.arange(len(result.lines), dtype=float)
    bars = []
    designs = ("before", result.start, palette.DESIGNS[0]), ("after", result.optimum, palette.DESIGNS[1])
    minimum = min(float(np.min(design.level[load] - design.level_error[load])) for _, design, _ in designs)
    floor = 5.0 * np.floor(minimum / 5.0 - 0.5)  # whole 5 dB, at least 2.5 dB below the lowest bar
    for side, (name, design, color) in zip((-0.5, 0.5), designs, strict=True):
        x = line + side * _WIDTH
        level, error = design.level[load], design.level_error[load]
        bars.append(Bars(name, x, level, base=floor, width=_WIDTH, color=color))
        bars.append(Bars("error", x, level + error, level - error, 0.4 * _WIDTH, palette.INK, veiled=True))
    names = [line if line == "all" else f"order {line}" for line in result.lines]
    return Panel(Axis.of_names(names), Axis(result.unit), bars=tuple(bars), title=_loads(result)[load])


def _levels_table(result: HeardOptimization) -> Table:
    head = ("load", "order", "before, dB", "after, dB", "change, dB", "± dB")
    rows = []
    before, after = result.start, result.optimum
    for load, torque in enumerate(_loads(result)):
        for line, name in enumerate(result.lines):
            first, second = before.level[load, line], after.level[load, line]
            error = before.level_error[load, line] + after.level_error[load, line]
            levels = (f"{first:.1f}", f"{second:.1f}", f"{second - first:+.1f}", number(error, 2))
            rows.append((torque, name, *levels))
    return Table(f"Levels without scatter, {result.unit}", head, tuple(rows))


def _flank_table(result: HeardOptimization) -> Table:
    head: tuple[str, ...] = (
        "load", "misalignment, µm", "ripple before, µm", "± µm", "ripple after, µm", "± µm",
        "pressure before, MPa", "± MPa", "after, MPa", "± MPa", "K_Hbeta before", "±", "after", "±",
    )  # fmt: skip
    before, after = result.start, result.optimum
    units = {"peak_to_peak": UM, "pressure": 1e6, "face_load_factor": 1.0}
    if np.all(np.isfinite(after.root_stress)):
        head += ("root stress before, MPa", "± MPa", "after, MPa", "± MPa")
        units["root_stress"] = 1e6
    rows = []
    for k, torque in enumerate(_loads(result)):
        row = [torque, number(result.misalignment[k] / UM, 3)]
        for name, unit in units.items():
            for design in (before, after):
                value = float(getattr(design, name)[k]) / unit
                error = float(getattr(design, f"{name}_error")[k]) / unit
                row += [to_error(value, error), error_text(value, error)]
        rows.append(tuple(row))
    return Table("Peak to peak of the transmission error, pressure and K_Hbeta", head, tuple(rows))


def _design_table(result: HeardOptimization) -> Table:
    rows = []
    for variable in result.variables:
        name = boundary_name(variable.name)
        values = result.start.values[variable.name], result.optimum.values[variable.name]
        ends = (*values, variable.low, variable.high)
        rows.append((name, *(number(value / factor(name), 4) for value in ends)))
    return Table("Design", ("variable", "start", "optimum", "least", "most"), tuple(rows))


def _text(result: HeardOptimization) -> Iterator[Table | str]:
    yield f"{result.reason}."
    yield from filter(None, (result.costs(), result.within_tolerances()))
    yield " ".join((result.ended(), *result.partings()))
    yield _design_table(result)
    yield _levels_table(result)
    yield _flank_table(result)


def _page(result: HeardOptimization) -> Page:
    gain = f"± {engineering(result.gain.error, 2)} dB"
    heads = (
        Headline("before", f"{result.start.objective.value:.1f} {result.unit}", _counted(result)),
        Headline("after", f"{result.optimum.objective.value:.1f} {result.unit}", _counted(result)),
        Headline("gain", f"{result.gain.value:.1f} dB", gain),
    )
    outcome = f"{result.reason}.", result.within_tolerances(), result.costs(), result.ended()
    lead = " ".join(filter(None, outcome))
    levels = Section("What is heard", "", (_levels_figure(result),), (_flank_table(result),))
    design = Section("Design", "", tables=(_design_table(result),))
    title = f"Flanks of {result.mesh} that are heard least"
    return Page(title, lead, heads, (levels, design), tuple(result.partings()))


LEVELS = Presentation(_levels_figure, _page, _text)
