"""Figures of a table over torque: ripple, deviations, flank pressure, and the load along the face.

Axes of arrays: P positions, F loads, M misalignments, n points of a plot, H harmonics.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fe_contact.ste import Curve, SteDatabase
from fe_contact.ste.fields import CENTER_DISTANCE, MISALIGNMENT
from fe_contact.types import BoolArray
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    Line,
    Panel,
    Reference,
    Table,
    number,
    ordered_lines,
    ripple_panel,
    um,
    unit_of,
)
from lineofaction.report.ste.curves import (
    aligned,
    aligned_index,
    drawn_loads,
    drawn_rows,
    headline_load,
    load_curve,
    load_labels,
    load_lines,
    position_axis,
    um_of,
)

HARMONICS = 8
_DEPTH = 1e-4  # lowest level drawn over the largest harmonic, -80 dB
_STEPS = 8
"""Steps of a curve between two requested loads of a table of one base pitch; more pitches cost more."""
_ROOM = 0.02  # margin at both ends of the axis over the range of torques


def ripple_over_torque(database: SteDatabase) -> Figure:
    """Draw over torque: peak-to-peak with its error, and the mesh harmonics in um and in dB."""
    requested = {load: load_curve(database, load) for load in drawn_loads(database)}
    curves, mark = _with_curves_between(database, requested)
    torque = np.array([curve.torque for curve in curves])
    across = _torque_axis(torque)
    value, error = np.stack([um_of(curve.harmonics[:HARMONICS]) for curve in curves], axis=1)
    known = ~(error >= value)  # true also for an error of NaN, which was not estimated
    level = 20.0 * np.log10(np.maximum(value, _DEPTH * value.max()))
    ripple, band = um_of([curve.peak_to_peak for curve in curves])
    lines = (
        Line("peak to peak", torque, ripple, palette.BLUE, band=band),
        Line("peak to peak", torque[mark], ripple[mark], palette.BLUE, width=0.0, markers=True),
    )
    text = _ripple_text({f"at {load_labels(database)[k]}": curve for k, curve in requested.items()})
    return Figure(
        key="ripple",
        title="Ripple over torque",
        caption="Peak-to-peak STE with the band of its error, and its mesh harmonics; dotted: below their "
        "errors. Points: requested torques, between which the table interpolates.",
        alternative=f"Of the requested torques: {text[0].lower()}{text[1:]}{_text_between(curves, mark)}",
        content=(
            ripple_panel(across, lines, title="Peak to peak"),
            _harmonics(across, torque, value, known, mark, "amplitude, µm"),
            _harmonics(across, torque, level, known, mark, "amplitude, dB re 1 µm"),
        ),
        table=_table(database, requested),
    )


def _with_curves_between(database: SteDatabase, requested: dict[int, Curve]) -> tuple[list[Curve], BoolArray]:
    """Return curves of rising load, some between the requested ones, and which of them were requested."""
    steps = max(_STEPS // database.period, 1)
    misalignment, change = aligned(database)
    point = {"misalignment": misalignment, "center_distance_change": change}
    curves = [*requested.values()][:1]
    for below, above in pairwise(requested):
        between = np.linspace(database.force[below], database.force[above], steps + 1)[1:-1]
        curves += [database.curve(force=float(force), **point, allow_failed=True) for force in between]
        curves.append(requested[above])
    return curves, np.arange(len(curves)) % steps == 0


def _torque_axis(torque: FloatArray) -> Axis:
    room = _ROOM * float(np.ptp(torque))
    return Axis("torque on the driving gear, N m", limits=(torque[0] - room, torque[-1] + room))


def _harmonics(
    across: Axis, torque: FloatArray, values: FloatArray, known: BoolArray, mark: BoolArray, label: str
) -> Panel:
    """Draw the harmonics (n, H), each labeled by its number; solid, marked lines where they are known."""
    lines: list[Line] = []
    for order in range(values.shape[1]):
        name, color = f"{order + 1}", palette.harmonic(order + 1)
        lines.append(Line(name, torque, values[:, order], color, "dot", 1.2, label=name))
        sure = np.where(known[:, order], values[:, order], np.nan)
        if known[:, order].any():
            lines.append(Line(name, torque, sure, color))
        if known[mark, order].any():
            lines.append(Line(name, torque[mark], sure[mark], color, width=0.0, markers=True))
    return Panel(across, Axis(label), tuple(lines), title=f"Mesh harmonics 1 to {HARMONICS}")


def _ripple_text(curves: dict[str, Curve]) -> str:
    """Return a sentence on the curves of the least and of the largest ripple, by name."""
    ripple = {name: curve.peak_to_peak for name, curve in curves.items()}
    lowest = min(ripple, key=lambda name: ripple[name].value)
    highest = max(ripple, key=lambda name: ripple[name].value)
    minimum, maximum = ripple[lowest], ripple[highest]
    least, largest = f"{um(minimum.value, 3)} µm {lowest}", f"{um(maximum.value, 3)} µm {highest}"
    if maximum.value - minimum.value <= minimum.error + maximum.error:
        return f"Peak to peak, {least} to {largest}, changes by no more than its errors."
    return f"Peak to peak is least, {least}, and largest, {largest}."


def _text_between(curves: list[Curve], requested: BoolArray) -> str:
    """Return a sentence on a least ripple that no requested torque has, beyond the errors; else nothing."""
    least = min(curves, key=lambda curve: curve.peak_to_peak.value)
    ripple = least.peak_to_peak
    others = [
        curve.peak_to_peak for curve, is_requested in zip(curves, requested, strict=True) if is_requested
    ]
    if not all(ripple.value + ripple.error < other.value - other.error for other in others):
        return ""  # an error that is not stated tells nothing apart
    return f" Between them it falls to {um(ripple.value, 3)} µm, at {number(least.torque, 3)} N m."


def _table(database: SteDatabase, curves: dict[int, Curve]) -> Table:
    labels = load_labels(database)
    rows = []
    for load, curve in curves.items():
        rows.append((labels[load], *(um(harmonic.value, 3) for harmonic in curve.harmonics[:HARMONICS])))
    head = ("torque", *(f"harmonic {k}, µm" for k in range(1, HARMONICS + 1)))
    return Table("Mesh harmonics by load", head, tuple(rows))


@dataclass(frozen=True)
class _Deviation:
    """A deviation of the alignment that has more than one value in a table."""

    name: str
    axis: Axis
    values: FloatArray
    """Values in the unit of `axis`. Shape (n,)."""
    curves: tuple[tuple[Curve, ...], ...]
    """Curves at each value, by load. Shape (n, F)."""

    @property
    def value_names(self) -> list[str]:
        """Names of the values, with their unit."""
        return [f"{self.name} {number(value, 3)} {unit_of(self.axis.label)}" for value in self.values]


def has_deviations(database: SteDatabase) -> bool:
    """Whether the database has an axis to draw over."""
    return max(database.misalignment.size, database.center_distance_change.size) > 1


def deviation_curves(database: SteDatabase) -> Figure:
    """Draw peak-to-peak STE of a few loads over misalignment, and over the change of center distance.

    Either is drawn if the table has more than one value of it, the other at its value nearest to zero.
    """
    deviations = _deviations(database)
    panels = []
    for deviation in deviations:
        ripples = [um_of([curve.peak_to_peak for curve in curves]) for curves in deviation.curves]
        value, error = np.stack(ripples, axis=1)
        lines = load_lines(database, deviation.values, value, bands=error)
        panels.append(ripple_panel(deviation.axis, lines))
    return Figure(
        key="deviations",
        title=f"Peak-to-peak transmission error over {' and '.join(d.name for d in deviations)}",
        caption="Bands: errors. Each deviation alone, the other at its stored value nearest to zero. "
        "Misalignment > 0: the gap grows towards the +z end of the face, and the load moves to the −z end. "
        "Seen from +z, the driving gear turns clockwise.",
        alternative=" ".join(_deviation_text(database, deviation) for deviation in deviations),
        content=tuple(panels),
        table=_deviation_table(database, deviations),
    )


def _deviations(database: SteDatabase) -> list[_Deviation]:
    misalignment, change = aligned(database)
    misalignments = database.requested_nodes(MISALIGNMENT)
    distance = database.requested_nodes(CENTER_DISTANCE)
    deviations = []
    if misalignments.size > 1:
        axis = Axis("misalignment over the common face width, µm")
        curves = tuple(_curves(database, float(m), change) for m in misalignments)
        deviations.append(_Deviation("misalignment", axis, 1e6 * misalignments, curves))
    if distance.size > 1:
        axis = Axis("change of the center distance, mm")
        curves = tuple(_curves(database, misalignment, float(d)) for d in distance)
        deviations.append(_Deviation("change of the center distance", axis, 1e3 * distance, curves))
    return deviations


def _curves(database: SteDatabase, misalignment: float, change: float) -> tuple[Curve, ...]:
    point = {"misalignment": misalignment, "center_distance_change": change}
    return tuple(database.curve(force=float(force), **point, allow_failed=True) for force in database.force)


def _deviation_text(database: SteDatabase, deviation: _Deviation) -> str:
    names = [f"at {name}" for name in deviation.value_names]
    text = _ripple_text(dict(zip(names, (row[-1] for row in deviation.curves), strict=True)))
    return f"At {load_labels(database)[-1]} {text[0].lower()}{text[1:]}"


def _deviation_table(database: SteDatabase, deviations: list[_Deviation]) -> Table:
    loads, labels = drawn_loads(database), load_labels(database)
    rows = []
    for deviation in deviations:
        for name, curves in zip(deviation.value_names, deviation.curves, strict=True):
            rows.append((name, *(um(curves[k].peak_to_peak.value) for k in loads)))
    return Table("Peak to peak, µm", ("deviation", *(labels[k] for k in loads)), tuple(rows))


def has_face_load(database: SteDatabase) -> bool:
    """Whether the load moves along the face: a table in three dimensions of a helical or misaligned pair."""
    moves = np.nanmax(database.face_centroid) - np.nanmin(database.face_centroid)
    return bool(moves > 1e-6 * database.geometry.face_width)


def face_load(database: SteDatabase, force: float | None = None) -> Figure:
    """Draw load centroid and peak pressure at the load nearest to `force`, one line per misalignment."""
    load = headline_load(database, force)
    _, d = aligned_index(database)
    misalignments = database.requested_rows(MISALIGNMENT)
    centroid = 1e3 * database.face_centroid[:, load, misalignments, d]
    pressure = 1e-6 * database.max_pressure[:, load, misalignments, d]
    label = load_labels(database)[load]
    waves = ""
    if database.geometry.base_helix_angle:
        waves = ", which fluctuates as the contact lines pass from slice to slice of the model"
    position, mid_face = position_axis(database), (Reference("mid-face", 0.0, "horizontal"),)
    return Figure(
        key="face_load",
        title="Load along the face",
        caption="First: distance of the load's centroid from the pinion's mid-face. Second: the largest "
        f"Hertz pressure anywhere on the flanks{waves}; at a tip edge the true pressure is singular.",
        alternative=f"At {label} the load acts from {number(np.nanmin(centroid), 3)} to "
        f"{number(np.nanmax(centroid), 3)} mm from mid-face; the largest pressure is "
        f"{number(np.nanmax(pressure), 3)} MPa.",
        content=(
            Panel(position, Axis("load centroid, mm"), _lines(database, centroid), mid_face, title=label),
            Panel(position, Axis("largest pressure, MPa"), _lines(database, pressure)),
        ),
    )


def _lines(database: SteDatabase, values: FloatArray) -> tuple[Line, ...]:
    """Draw `values` (P, M) over the pitches shown, dark for the first misalignment."""
    position, rows = drawn_rows(database)
    names = [f"misalignment {number(1e6 * float(m), 3)} µm" for m in database.requested_nodes(MISALIGNMENT)]
    return ordered_lines(position, names, values[rows].T, labeled=len(names) > 1)


def flanks_over_torque(database: SteDatabase) -> Figure:
    """Draw the largest pressure over torque, and where the load moves along the face, its range."""
    loads = list(drawn_loads(database))
    m, d = aligned_index(database)
    torque = database.torque[loads]
    across = _torque_axis(torque)
    pressure = 1e-6 * np.nanmax(database.max_pressure[:, loads, m, d], axis=0)
    centroid = 1e3 * database.face_centroid[:, loads, m, d]
    ends = np.stack([np.nanmin(centroid, axis=0), np.nanmean(centroid, axis=0), np.nanmax(centroid, axis=0)])
    y = Axis("largest pressure, MPa", limits=(0.0, 1.05 * float(pressure.max())))
    line = Line("largest pressure", torque, pressure, palette.BLUE, markers=True)
    panels = [Panel(across, y, (line,), title="Flank pressure")]
    title = "Flank pressure over torque"
    caption = "The largest Hertz pressure of the mesh cycle at every stored load"
    if has_face_load(database):
        panels.append(_centroid(across, torque, ends))
        title = "Flank pressure and load centroid over torque"
        caption += "; then how far the load's centroid is from the pinion's mid-face"
    return Figure(
        key="flanks_over_torque",
        title=title,
        caption=f"{caption}.",
        alternative=_flanks_text(database, loads, pressure),
        content=tuple(panels),
        table=_flanks_table(database, loads, pressure, ends),
    )


def _centroid(across: Axis, torque: FloatArray, ends: FloatArray) -> Panel:
    least, mean, largest = ends
    lines = (
        Line("least", torque, least, palette.SKY, markers=True, label="least"),
        Line("mean", torque, mean, palette.BLUE, markers=True, label="mean"),
        Line("largest", torque, largest, palette.VERMILLION, markers=True, label="largest"),
    )
    mark = Reference("mid-face", 0.0, "horizontal")
    return Panel(across, Axis("load centroid, mm"), lines, (mark,), title="Load along the face")


def _flanks_text(database: SteDatabase, loads: list[int], pressure: FloatArray) -> str:
    names, torque = load_labels(database), database.torque
    first, last = loads[0], loads[-1]
    growth = f"{number(torque[last] / torque[first], 3)} times the torque"
    return (
        f"The largest pressure grows from {number(pressure[0], 3)} MPa at {names[first]} to "
        f"{number(pressure[-1], 3)} MPa at {names[last]}: "
        f"{number(pressure[-1] / pressure[0], 3)} times for {growth}."
    )


def _flanks_table(database: SteDatabase, loads: list[int], pressure: FloatArray, ends: FloatArray) -> Table:
    labels = load_labels(database)
    rows = []
    for k, largest, centroids in zip(loads, pressure, ends.T, strict=True):
        rows.append((labels[k], number(largest, 4), *(number(end, 3) for end in centroids)))
    heads = (f"{name} centroid, mm" for name in ("least", "mean", "largest"))
    return Table("Flanks by load", ("torque", "largest pressure, MPa", *heads), tuple(rows))
