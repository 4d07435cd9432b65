"""Loads and pressures of each tooth, where the teeth of a gear differ: the worst one, and all of them."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase, ToothLoads
from fe_contact.types import BoolArray
from lineofaction.gearbox.convert.answers import GEARS, teeth_text
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Bars,
    Figure,
    HeatMap,
    Line,
    Note,
    Panel,
    Reference,
    Table,
    number,
)
from lineofaction.report.drawing.page import Headline, Section
from lineofaction.report.ste.curves import aligned, load_labels

UNBOUNDED = "no error is stated for it"
"""Remark on the largest pressure: its place changes with mesh and slices, so that no error is known."""
_WAY = "way of the pair through mesh, base pitches (0 = at the pitch point in mid-face)"
_DERIVED = " Some base pitches were not solved but found by derivatives, to within"
_WIDTH = 0.8  # width of a bar over the distance of teeth
_ABOVE = 1.15  # top of the axis over the largest bar, with room for the number of its tooth
_RANKED = 5  # teeth of a gear in the table
_NAMED = 3  # most teeth of equal load that are named in the picture
_STEPS, _TICKS = (1, 2, 5, 10, 20, 50, 100), 12  # between ticks of teeth, and how many there are at most


def teeth_at(database: SteDatabase, load: int) -> tuple[ToothLoads, ...]:
    """Return the loads of the teeth of the aligned pair at a stored load; none where teeth are alike."""
    misalignment, change = aligned(database)
    return database.tooth_loads(
        force=float(database.force[load]),
        misalignment=misalignment,
        center_distance_change=change,
        allow_failed=True,
    )


def tooth_headlines(database: SteDatabase, load: int) -> tuple[Headline, ...]:
    """Name the teeth of the largest force and of the largest pressure of each gear whose teeth differ."""
    label = load_labels(database)[load]
    headlines = []
    for loads in teeth_at(database, load):
        tooth = f"tooth of the {GEARS[loads.gear]} at {label}"
        if loads.most_loaded:
            headlines.append(Headline(f"most loaded {tooth}", teeth_text(loads.most_loaded), _size(loads)))
        if loads.most_pressed:
            remark = f"{_megapascal(loads.pressure.max())}; {UNBOUNDED}"
            headlines.append(Headline(f"most pressed {tooth}", teeth_text(loads.most_pressed), remark))
    return tuple(headlines)


def _size(loads: ToothLoads) -> str:
    return f"{number(loads.force.max(), 4)} N, {loads.over_mean:.3f} times the mean tooth"


def _megapascal(pressure: float) -> str:
    return f"{number(1e-6 * float(pressure), 4)} MPa"


def tooth_sections(database: SteDatabase, load: int) -> tuple[Section, ...]:
    """Return the section of the largest load and pressure of each tooth; none where teeth are alike."""
    teeth = teeth_at(database, load)
    loaded = tuple(loads for loads in teeth if loads.most_loaded)
    figures = [_loads(database, load, loaded)] if loaded else []
    figures += [_pressures(database, load, loads) for loads in teeth if loads.most_pressed]
    return (Section("Load of each tooth", figures=tuple(figures)),) if figures else ()


def _loads(database: SteDatabase, load: int, teeth: tuple[ToothLoads, ...]) -> Figure:
    return Figure(
        key="tooth_loads",
        title=f"Largest load on each tooth at {load_labels(database)[load]}",
        caption="The largest normal force on a tooth over all mates that it meets in the "
        f"{database.period} base pitches of the table. Teeth count in the order of meshing: tooth 1 of both "
        f"gears touches at the pitch point at position 0.{_derived(database, load)}",
        alternative=" ".join(_finding(loads) for loads in teeth),
        content=tuple(_bars(loads) for loads in teeth),
        table=_table(teeth),
    )


def _finding(loads: ToothLoads) -> str:
    minimum = int(np.argmin(loads.force))
    return (
        f"The largest force on the {GEARS[loads.gear]} is on {teeth_text(loads.most_loaded)}, "
        f"{_size(loads)}; "
        f"on tooth {minimum + 1} it is least, {number(loads.force[minimum], 4)} N."
    )


def _derived(database: SteDatabase, load: int) -> str:
    """Return a sentence on the error of forces, if some base pitches were not solved."""
    share_error = database.metadata.receipt.get("cycle", {}).get("share_error")
    if share_error is None:
        return ""
    force = number(float(share_error) * float(database.force[load]), 2)
    return f"{_DERIVED} {force} N at 99 % of the drawn points."


def _bars(loads: ToothLoads) -> Panel:
    force, name = loads.force, GEARS[loads.gear]
    maximum, mean, tooth = float(force.max()), float(force.mean()), np.arange(1.0, force.size + 1.0)
    return Panel(
        _tooth_axis(loads),
        Axis("largest normal force, N", limits=(0.0, _ABOVE * maximum)),
        references=(Reference("", mean, "horizontal"),),
        title=f"{name.capitalize()}; dashed: mean {number(mean, 4)} N",
        notes=_notes(loads.most_loaded, maximum, force.size),
        bars=(Bars("force", tooth, force, base=0.0, width=_WIDTH, color=palette.GEARS[loads.gear]),),
    )


def _notes(teeth: tuple[int, ...], height: float, count: int) -> tuple[Note, ...]:
    """Write the numbers of the worst teeth above their bars, if these are few."""
    if len(teeth) > _NAMED:
        return ()
    late = [tooth > 0.5 * count for tooth in teeth]  # on the right half: the number left of its bar's edge
    return tuple(
        Note(tooth + (0.5 if left else -0.5), height, str(tooth), left=left)
        for tooth, left in zip(teeth, late, strict=True)
    )


def _tooth_axis(loads: ToothLoads) -> Axis:
    """Return the axis of teeth, named at whole numbers."""
    count = loads.force.size
    step = next((size for size in _STEPS if count <= _TICKS * size), count)
    names = tuple((float(tooth), str(tooth)) for tooth in range(step, count + 1, step))
    return Axis(f"tooth of the {GEARS[loads.gear]}", limits=(0.5, count + 0.5), names=names)


def _table(teeth: tuple[ToothLoads, ...]) -> Table:
    rows = tuple(
        (
            GEARS[loads.gear],
            str(tooth + 1),
            number(loads.force[tooth], 4),
            f"{loads.force[tooth] / loads.force.mean():.3f}",
        )
        for loads in teeth
        for tooth in np.argsort(-loads.force, kind="stable")[:_RANKED]
    )
    return Table(
        "Most loaded teeth", ("gear", "tooth", "largest normal force, N", "over the mean tooth"), rows
    )


def _pressures(database: SteDatabase, load: int, loads: ToothLoads) -> Figure:
    error = database.metadata.receipt.get("cycle", {}).get("pressure_error_relative")
    peak, least = float(loads.pressure.max()), int(np.argmin(loads.pressure))
    derived = "" if error is None else f"{_DERIVED} {_megapascal(error * peak)} at 99 % of the drawn points."
    name = GEARS[loads.gear]
    return Figure(
        key=f"tooth_pressures_{name}",
        title=f"Pressure on each tooth of the {name} at {load_labels(database)[load]}",
        caption="Map: the largest Hertz pressure anywhere on a tooth, away from edges, as its pair passes "
        "through mesh, the largest of all its mates; blank: nothing touches. Curves: the most pressed tooth "
        f"beside the mean of all teeth.{derived}",
        alternative=f"The largest pressure on the {name} is on {teeth_text(loads.most_pressed)}, "
        f"{_megapascal(peak)}; on tooth {least + 1} it is least, {_megapascal(loads.pressure[least])}.",
        content=(_map(loads), _way(loads)),
        table=_pressure_table(loads),
    )


def _in_mesh(loads: ToothLoads) -> tuple[Axis, BoolArray]:
    """Return the axis of the way through mesh, and a mask of the columns in which a tooth is pressed."""
    pressed = np.flatnonzero((loads.pressure_over_phase > 0.0).any(axis=0))
    inside = np.zeros(loads.phase.size, dtype=bool)
    # and a column on either side, so that curves come down to zero
    inside[max(pressed[0] - 1, 0) : pressed[-1] + 2] = True
    return Axis.over(_WAY, loads.phase[inside]), inside


def _map(loads: ToothLoads) -> Panel:
    x, inside = _in_mesh(loads)
    pressure = 1e-6 * loads.pressure_over_phase[:, inside]
    teeth, touching = np.arange(1.0, len(pressure) + 1.0), np.where(pressure > 0.0, pressure, np.nan)
    shade = HeatMap.spanning(loads.phase[inside], teeth, touching, "Hertz pressure, MPa")
    return Panel(x, _tooth_axis(loads), shade=shade)


def _way(loads: ToothLoads) -> Panel:
    x, inside = _in_mesh(loads)
    pressure = 1e-6 * loads.pressure_over_phase[:, inside]
    phase, worst = loads.phase[inside], loads.most_pressed[0]
    lines = (
        Line(f"tooth {worst}", phase, pressure[worst - 1], palette.GEARS[loads.gear]),
        Line("mean of all teeth", phase, np.nanmean(pressure, axis=0), palette.MUTED, "dash"),
    )
    y = Axis("largest Hertz pressure, MPa", limits=(0.0, 1.05 * float(np.nanmax(pressure))))
    return Panel(x, y, lines)


def _pressure_table(loads: ToothLoads) -> Table:
    rows = tuple(
        (str(tooth + 1), number(1e-6 * loads.pressure[tooth], 4))
        for tooth in np.argsort(-loads.pressure, kind="stable")[:_RANKED]
    )
    return Table(f"Most pressed teeth of the {GEARS[loads.gear]}", ("tooth", "largest pressure, MPa"), rows)
