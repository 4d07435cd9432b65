"""Peak-to-peak transmission error over the misalignment and center-distance axes of a database."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fe_contact.ste import SteDatabase
from service.drawing.figure import Axis, Figure, FloatArray, Panel, Table, number
from service.tables.aligned import aligned, load_labels, load_lines, shown_loads

_RIPPLE = Axis("peak to peak, µm")
_MISALIGNMENT = Axis("misalignment over the common face width, µm")
_DISTANCE = Axis("change of the center distance, mm")


def has_deviations(database: SteDatabase) -> bool:
    """Whether the database has an axis to draw over."""
    return max(database.misalignment.size, database.center_distance_change.size) > 1


def deviation_curves(database: SteDatabase) -> Figure:
    """Draw peak-to-peak STE, one line per load, over each axis of more than one value.

    The other deviation is kept at the value nearest to zero.
    """
    misalignment, change = aligned(database)
    axes: list[tuple[Axis, FloatArray, FloatArray]] = []
    if database.misalignment.size > 1:
        values = _ripple(database, database.misalignment, lambda m: (m, change))
        axes.append((_MISALIGNMENT, 1e6 * database.misalignment, values))
    if database.center_distance_change.size > 1:
        values = _ripple(database, database.center_distance_change, lambda d: (misalignment, d))
        axes.append((_DISTANCE, 1e3 * database.center_distance_change, values))
    return Figure(
        key="deviations",
        title="Peak-to-peak transmission error over misalignment and center distance",
        caption="Each deviation alone, the other at its stored value nearest to zero. Misalignment > 0: "
        "the gap grows along the face, and the load moves to the other side.",
        alternative=_words(database, axes),
        content=tuple(Panel(x, _RIPPLE, load_lines(database, at, values)) for x, at, values in axes),
        table=_table(database, axes),
    )


def _ripple(
    database: SteDatabase, deviations: FloatArray, point: Callable[[float], tuple[float, float]]
) -> FloatArray:
    """Peak to peak in um (n, F) at the places of the deviations."""
    ripple = np.empty((deviations.size, database.force.size))
    for i, deviation in enumerate(deviations):
        misalignment, change = point(float(deviation))
        for k, force in enumerate(database.force):
            curve = database.curve(
                force=float(force),
                misalignment=misalignment,
                center_distance_change=change,
                allow_failed=True,
            )
            ripple[i, k] = 1e6 * curve.peak_to_peak.value
    return ripple


def _words(database: SteDatabase, axes: list[tuple[Axis, FloatArray, FloatArray]]) -> str:
    """Say how far peak to peak ranges at the largest load."""
    label = load_labels(database)[-1]
    parts = [
        f"from {number(float(values[:, -1].min()), 3)} to {number(float(values[:, -1].max()), 3)} µm "
        f"over {x.label.partition(',')[0]}"
        for x, _, values in axes
    ]
    return f"At {label} peak to peak ranges {' and '.join(parts)}."


def _table(database: SteDatabase, axes: list[tuple[Axis, FloatArray, FloatArray]]) -> Table:
    """Every load at every deviation."""
    loads = shown_loads(database)
    labels = load_labels(database)
    rows = tuple(
        (f"{x.label.partition(' over')[0].partition(',')[0]} {number(float(value), 3)} {unit}", *figures)
        for (x, at, values), unit in zip(axes, (a.label.rpartition(", ")[2] for a, _, _ in axes), strict=True)
        for value, figures in zip(at, _texts(values, loads), strict=True)
    )
    return Table("Peak to peak, µm", ("deviation", *(labels[k] for k in loads)), rows)


def _texts(values: FloatArray, loads: tuple[int, ...]) -> list[tuple[str, ...]]:
    """Figures of the loads shown, row by row."""
    return [tuple(number(float(row[k])) for k in loads) for row in values]
