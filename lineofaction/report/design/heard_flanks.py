"""Quietest flanks of a scene: levels before and after by load case, and figures that get worse."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bounds import engineering
from bounds.error_digits import error_text, to_error
from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.studies.optimize.result import HeardDesign, HeardOptimization
from lineofaction.gearbox.units import UM, factor
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Figure, Panel, Table, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation

_WIDTH = 0.32
"""Width of a bar, two of which stand at an order."""


def _loads(result: HeardOptimization) -> tuple[str, ...]:
    return tuple(f"{torque:.4g} N m" for torque in result.torque)


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
    line, bars = np.arange(len(result.lines), dtype=float), []
    designs = ("before", result.start, palette.DESIGNS[0]), ("after", result.optimum, palette.DESIGNS[1])
    minimum = min(float(np.min(design.level[load] - design.level_error[load])) for _, design, _ in designs)
    floor = 5.0 * np.floor(minimum / 5.0 - 0.5)  # whole 5 dB, at least 2.5 dB below the lowest bar
    for side, (name, design, color) in zip((-0.5, 0.5), designs, strict=True):
        x, level, error = line + side * _WIDTH, design.level[load], design.level_error[load]
        bars.append(Bars(name, x, level, floor, _WIDTH, color))
        bars.append(Bars("error", x, level + error, level - error, 0.4 * _WIDTH, palette.INK, veiled=True))
    names = [line if line == "all" else f"order {line}" for line in result.lines]
    return Panel(Axis.of_names(names), Axis(result.unit), bars=tuple(bars), title=_loads(result)[load])


def _levels_table(result: HeardOptimization) -> Table:
    head = ("load", "order", "before, dB", "after, dB", "change, dB", "± dB")
    rows = []
    before, after = result.start, result.optimum
    for load, torque in enumerate(_loads(result)):
        for line, name in enumerate(result.lines):
            index = load, line
            rows.append(
                (
                    torque,
                    name,
                    f"{before.level[index]:.1f}",
                    f"{after.level[index]:.1f}",
                    f"{after.level[index] - before.level[index]:+.1f}",
                    number(before.level_error[index] + after.level_error[index], 2),
                )
            )
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
    rows = tuple(
        (
            torque,
            number(result.misalignment[k] / UM, 3),
            *(
                text
                for name, unit in units.items()
                for design in (before, after)
                for text in _value_and_error(design, name, k, unit)
            ),
        )
        for k, torque in enumerate(_loads(result))
    )
    return Table("Peak to peak of the transmission error, pressure and K_Hbeta", head, rows)


def _value_and_error(design: HeardDesign, name: str, load: int, unit: float) -> tuple[str, str]:
    value, error = (float(getattr(design, field)[load]) / unit for field in (name, f"{name}_error"))
    return to_error(value, error), error_text(value, error)


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
        Headline("before", f"{result.start.objective.value:.1f} {result.unit}"),
        Headline("after", f"{result.optimum.objective.value:.1f} {result.unit}"),
        Headline("gain", f"{result.gain.value:.1f} dB", gain),
    )
    outcome = f"{result.reason}.", result.within_tolerances(), result.costs(), result.ended()
    lead = " ".join(filter(None, outcome))
    levels = Section("What is heard", "", (_levels_figure(result),), (_flank_table(result),))
    design = Section("Design", "", tables=(_design_table(result),))
    return Page(
        f"Flanks of {result.mesh} that are heard least",
        lead,
        heads,
        (levels, design),
        tuple(result.partings()),
    )


LEVELS = Presentation(_levels_figure, _page, _text)
