"""What the mean transmission error under load is made of: teeth, bodies, contact, modifications, shafts."""

from __future__ import annotations

import numpy as np

from fe_contact.effects import EFFECTS, ContactScene
from fe_contact.effects.influence import DeflectionBudget, deflection_budget
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Figure, Note, Panel, Table, number
from lineofaction.report.tables.aligned import aligned, load_curve, load_labels
from lineofaction.report.tables.pair import pair_of

_UM = 1e6
_ROOM = 1.2  # of the largest part: for the numbers
_NOTE = 0.4  # of the distance of bars: for the number of the last one on a narrow screen
_LEAST = 0.0005
"""Part of the mean below which there is no bar."""


def budget_figure(database: SteDatabase, load: int) -> Figure | None:
    """Draw the parts of the mean STE at a stored load as bars; None without a pair."""
    budget = _budget(database, load)
    if budget is None:
        return None
    mean = _UM * float(np.mean(budget.total))
    parts = {name: sides for name, sides in _parts(budget).items() if _counts(sides, mean)}
    table_mean = _UM * load_curve(database, load).mean.value
    return Figure(
        key="deflection_budget",
        title=f"Parts of the mean transmission error at {load_labels(database)[load]}",
        caption="Each part is its displacement along the line of action, weighted by the forces on the "
        "flanks. Teeth, bodies and contact are springs in closed form here: their mean is "
        f"{number(mean, 4)} µm, that of the table {number(table_mean, 4)} µm.",
        alternative=_words(parts, mean, load_labels(database)[load]),
        content=(_panel(parts, mean),),
        table=_table(parts, mean),
    )


def _budget(database: SteDatabase, load: int) -> DeflectionBudget | None:
    """Split the transmission error of the table's model."""
    pair, ledger = pair_of(database), database.metadata.effect_ledger
    entries: list[Json] = (
        [{"name": k, **v} for k, v in ledger.items()] if isinstance(ledger, dict) else ledger
    )
    if pair is None:
        return None
    skew, change = (np.array([value]) for value in aligned(database))
    scene = ContactScene(pair, database.torque[load : load + 1], EFFECTS, skew, change)
    known = {effect.name for effect in EFFECTS}
    choices = {
        str(entry["name"]): "on" if entry["on"] else "off" for entry in entries if entry["name"] in known
    }
    return deflection_budget(scene, choices)


def _parts(budget: DeflectionBudget) -> dict[str, tuple[float, ...]]:
    """Return the means in um by name, one value or those of pinion and wheel."""

    def means(*values: FloatArray) -> tuple[float, ...]:
        return tuple(_UM * float(np.mean(value)) for value in values)

    return {
        "tooth bending and shear": means(*budget.teeth),
        "gear bodies": means(*budget.bodies),
        "Hertz contact": means(budget.contact),
        "shafts and bearings": means(budget.shafts),
        "flank modifications": means(budget.modification),
        "misalignment": means(budget.misalignment),
        "tip corners": means(budget.corner),
    }


def _counts(sides: tuple[float, ...], mean: float) -> bool:
    return abs(sum(sides)) > _LEAST * mean


def _panel(parts: dict[str, tuple[float, ...]], mean: float) -> Panel:
    """Draw one bar for each part, its size above it."""
    place, sizes = np.arange(len(parts), dtype=float), np.array([sum(sides) for sides in parts.values()])
    notes = tuple(
        Note(
            float(x) - 0.2,
            max(float(size), 0.0),
            f"{number(float(size), 3)} µm, {number(100.0 * float(size) / mean, 2)} %",
        )
        for x, size in zip(place, sizes, strict=True)
    )
    names = tuple(zip(map(float, place), parts, strict=True))
    x = Axis("", limits=(-0.6, len(parts) + _NOTE), names=names)
    y = Axis(
        "part of the mean STE, µm", limits=(min(0.0, _ROOM * float(sizes.min())), _ROOM * float(sizes.max()))
    )
    return Panel(
        x, y, notes=notes, bars=(Bars("part of the mean STE", place, sizes, 0.0, 0.6, palette.BLUE),)
    )


def _words(parts: dict[str, tuple[float, ...]], mean: float, label: str) -> str:
    """Name the largest part."""
    name = max(parts, key=lambda name: sum(parts[name]))
    size = sum(parts[name])
    share = f"{number(size, 3)} of {number(mean, 4)} µm, {number(100.0 * size / mean, 2)} %"
    return f"At {label} the largest part of the mean transmission error is of {name}: {share}."


def _table(parts: dict[str, tuple[float, ...]], mean: float) -> Table:
    """Both gears' parts, their sum, and its part of the mean."""
    rows = tuple(
        (
            name,
            *(number(side, 3) if len(sides) > 1 else "" for side in (sides * 2)[:2]),
            number(sum(sides), 3),
            f"{100.0 * sum(sides) / mean:.1f}",
        )
        for name, sides in parts.items()
    )
    head = ("part", "pinion, µm", "wheel, µm", "both, µm", "% of the mean")
    return Table("Parts of the mean transmission error", head, rows)
