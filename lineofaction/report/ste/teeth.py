"""Loads of each tooth, where the teeth of a gear differ: the most loaded one, and all of them."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase, ToothLoads
from lineofaction.gearbox.convert.answers import GEARS
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Bars,
    Figure,
    Note,
    Panel,
    Reference,
    Table,
    number,
)
from lineofaction.report.drawing.page import Headline, Section
from lineofaction.report.ste.curves import aligned, load_labels

_COLORS = palette.BLUE, palette.VERMILLION
_WIDTH = 0.8  # of a bar
_ABOVE = 1.15  # of the largest: for the number of its tooth
_RANKED = 5  # teeth of a gear in the table


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
    """Name the most loaded tooth of each gear whose teeth differ."""
    label = load_labels(database)[load]
    return tuple(
        Headline(f"most loaded tooth of the {GEARS[own.gear]} at {label}", f"tooth {own.worst}", _size(own))
        for own in teeth_at(database, load)
    )


def _size(own: ToothLoads) -> str:
    return f"{number(own.force.max(), 4)} N, {own.over_mean:.3f} times the mean tooth"


def tooth_sections(database: SteDatabase, load: int) -> tuple[Section, ...]:
    """Show the largest load on each tooth where teeth differ."""
    teeth = teeth_at(database, load)
    return (Section("Load of each tooth", figures=(_loads(database, load, teeth),)),) if teeth else ()


def _loads(database: SteDatabase, load: int, teeth: tuple[ToothLoads, ...]) -> Figure:
    label = load_labels(database)[load]
    return Figure(
        key="tooth_loads",
        title=f"Largest load on each tooth at {label}",
        caption="The largest normal force on a tooth over all mates that it meets in the "
        f"{database.period} base pitches of the table. Teeth count in the order of meshing: tooth 1 of both "
        f"gears touches at the pitch point at position 0.{_derived(database, load)}",
        alternative=" ".join(_finding(own) for own in teeth),
        content=tuple(_bars(own) for own in teeth),
        table=_table(teeth),
    )


def _finding(own: ToothLoads) -> str:
    least = int(np.argmin(own.force))
    return (
        f"Tooth {own.worst} of the {GEARS[own.gear]} carries most, {_size(own)}; tooth {least + 1} least, "
        f"{number(own.force[least], 4)} N."
    )


def _derived(database: SteDatabase, load: int) -> str:
    """Say what derivatives may change of the forces, where base pitches follow from them."""
    missed = database.metadata.receipt.get("cycle", {}).get("share_error")
    if missed is None:
        return ""
    force = number(float(missed) * float(database.force[load]), 2)
    return f" Base pitches by derivatives: within {force} N at 99 % of the drawn points."


def _bars(own: ToothLoads) -> Panel:
    tooth, force = np.arange(1.0, own.force.size + 1.0), own.force
    name, most, mean = GEARS[own.gear], float(force.max()), float(force.mean())
    late = own.worst > 0.5 * force.size
    return Panel(
        Axis(f"tooth of the {name}", limits=(0.4, force.size + 0.6)),
        Axis("largest normal force, N", limits=(0.0, _ABOVE * most)),
        references=(Reference("", mean, "horizontal"),),
        title=f"{name.capitalize()}; dashed: mean {number(mean, 4)} N",
        notes=(Note(own.worst + (0.5 if late else -0.5), most, f"tooth {own.worst}", left=late),),
        bars=(Bars(name, tooth, force, 0.0, _WIDTH, _COLORS[own.gear]),),
    )


def _table(teeth: tuple[ToothLoads, ...]) -> Table:
    rows = tuple(
        (
            GEARS[own.gear],
            str(tooth + 1),
            number(own.force[tooth], 4),
            f"{own.force[tooth] / own.force.mean():.3f}",
        )
        for own in teeth
        for tooth in np.argsort(-own.force, kind="stable")[:_RANKED]
    )
    return Table(
        "Most loaded teeth", ("gear", "tooth", "largest normal force, N", "over the mean tooth"), rows
    )
