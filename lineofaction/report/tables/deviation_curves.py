"""Peak-to-peak transmission error over the misalignment and center-distance axes of a database."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fe_contact.ste import Curve, SteDatabase
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Panel, Table, number, unit_of
from lineofaction.report.tables.aligned import aligned, few_loads, load_labels, load_lines, shown_loads
from lineofaction.report.tables.ripple_over_torque import ripple_words


@dataclass(frozen=True)
class _Deviation:
    """One axis of more than one value: how it is named, its values, and the curves (n, F) there."""

    name: str
    axis: Axis
    at: FloatArray
    curves: tuple[tuple[Curve, ...], ...]

    @property
    def places(self) -> list[str]:
        """Name its values."""
        return [f"{self.name} {number(float(value), 3)} {unit_of(self.axis.label)}" for value in self.at]


def has_deviations(database: SteDatabase) -> bool:
    """Whether the database has an axis to draw over."""
    return max(database.misalignment.size, database.center_distance_change.size) > 1


def deviation_curves(database: SteDatabase) -> Figure:
    """Draw peak-to-peak STE, one line for each of a few loads, over each axis of more than one value.

    The other deviation is kept at the value nearest to zero.
    """
    deviations = _deviations(database)
    return Figure(
        key="deviations",
        title=f"Peak-to-peak transmission error over {' and '.join(d.name for d in deviations)}",
        caption="Bands: errors. Each deviation alone, the other at its stored value nearest to zero. "
        "Misalignment > 0: the gap grows towards the +z end of the face, and the load moves to the −z end. "
        "Seen from +z, the driving gear turns clockwise.",
        alternative=" ".join(_words(database, deviation) for deviation in deviations),
        content=tuple(_panel(database, deviation) for deviation in deviations),
        table=_table(database, deviations),
    )


def _deviations(database: SteDatabase) -> list[_Deviation]:
    """Return the axes of more than one value."""
    misalignment, change = aligned(database)
    skew, distance = database.misalignment, database.center_distance_change
    found = []
    if skew.size > 1:
        axis = Axis("misalignment over the common face width, µm")
        curves = tuple(_curves(database, float(m), change) for m in skew)
        found.append(_Deviation("misalignment", axis, 1e6 * skew, curves))
    if distance.size > 1:
        axis = Axis("change of the center distance, mm")
        curves = tuple(_curves(database, misalignment, float(d)) for d in distance)
        found.append(_Deviation("change of the center distance", axis, 1e3 * distance, curves))
    return found


def _curves(database: SteDatabase, misalignment: float, change: float) -> tuple[Curve, ...]:
    point = {"misalignment": misalignment, "center_distance_change": change}
    return tuple(database.curve(force=float(force), **point, allow_failed=True) for force in database.force)


def _panel(database: SteDatabase, deviation: _Deviation) -> Panel:
    """Draw peak-to-peak and its error."""
    sizes = [[curve.peak_to_peak for curve in row] for row in deviation.curves]
    value, error = (
        1e6 * np.array(these)
        for these in ([[e.value for e in row] for row in sizes], [[e.error for e in row] for row in sizes])
    )
    lines = tuple(
        replace(line, markers=True, band=error[:, k])
        for line, k in zip(load_lines(database, deviation.at, value), few_loads(database), strict=True)
    )
    top = 1.05 * max(float(np.nanmax(line.y + np.nan_to_num(line.band))) for line in lines)
    return Panel(deviation.axis, Axis("peak to peak, µm", limits=(0.0, top)), lines)


def _words(database: SteDatabase, deviation: _Deviation) -> str:
    """Say where peak to peak is least and largest at the largest load."""
    names = [f"at {name}" for name in deviation.places]
    said = ripple_words(dict(zip(names, (row[-1] for row in deviation.curves), strict=True)))
    return f"At {load_labels(database)[-1]} {said[0].lower()}{said[1:]}"


def _table(database: SteDatabase, deviations: list[_Deviation]) -> Table:
    """Every load at every deviation."""
    loads, labels = shown_loads(database), load_labels(database)
    rows = tuple(
        (name, *(number(1e6 * row[k].peak_to_peak.value) for k in loads))
        for deviation in deviations
        for name, row in zip(deviation.places, deviation.curves, strict=True)
    )
    return Table("Peak to peak, µm", ("deviation", *(labels[k] for k in loads)), rows)
