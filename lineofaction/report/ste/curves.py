"""The transmission error of a table: its curves, Harris map and spectrum, for the aligned pair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from bounds.error_digits import to_error, with_error
from fe_contact.ste import Curve, SteDatabase
from fe_contact.ste.fields import CENTER_DISTANCE, MISALIGNMENT
from fe_contact.types import Estimate, IntArray
from lineofaction.gearbox.units import UM
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    Line,
    Panel,
    Table,
    number,
    ordered_lines,
    thousands,
    um,
)

POINTS_PER_PITCH = 240  # drawn points of one base pitch, besides the stored ones
POSITION_LABEL = "position of the driving gear, base pitches (0 = reference pair at the pitch point)"
MAX_PITCHES = 40  # most base pitches of a long period in a plot
MAX_LINES = 5  # most loads in one panel
_FEWEST_POINTS = 32  # drawn points of a base pitch where many pitches share `POINTS_PER_PITCH`
_LIFT_OFF = 0.002  # loads up to this part of the largest serve lift-off
_CURVES: WeakKeyDictionary[SteDatabase, dict[int, Curve]] = WeakKeyDictionary()
"""Curves of a database by load index: figures of one page share them."""
_EQUAL = 1e-6  # means that differ by less than this part of themselves are equal
MAX_CURVES = 8  # most curves in a Harris map
_MIN_SPACING = 1.1  # least distance of two curves over the distance at which they would touch
_MIN = 0.15  # least distance of curves that would not touch anyway, over the largest ripple
_ROOM = 0.04  # margin above and below the curves over the height
_TONES = 3  # harmonics of the mesh frequency in the table
_MIN_ROOM, _MAX_ROOM = 0.08, 0.45
"""Least and largest room above and below the ripple, over the ripple. The error band fills the room up to the
largest, so that the ripple takes at least half of the height."""
_FLAT = 1e-3  # height of a curve without any ripple, µm


def aligned_index(database: SteDatabase) -> tuple[int, int]:
    """Return the indices on the misalignment and center-distance axes, of requested nodes nearest to zero."""
    m, d = (_nearest(database, axis) for axis in (MISALIGNMENT, CENTER_DISTANCE))
    return m, d


def _nearest(database: SteDatabase, axis: str) -> int:
    size = np.where(database.requested_rows(axis), np.abs(getattr(database, axis)), np.inf)
    return int(np.argmin(size))


def aligned(database: SteDatabase) -> tuple[float, float]:
    """Return the misalignment and center-distance change (m) that plots show."""
    m, d = aligned_index(database)
    return float(database.misalignment[m]), float(database.center_distance_change[d])


def drawn_pitches(database: SteDatabase) -> int:
    """Return the number of base pitches in plots: two, or a longer period up to its first 40."""
    return 2 if database.period == 1 else min(database.period, MAX_PITCHES)


def position_axis(database: SteDatabase) -> Axis:
    """Return the axis of the positions shown."""
    return Axis(POSITION_LABEL, limits=(0, drawn_pitches(database)))


def drawn_rows(database: SteDatabase) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return the positions shown, (n,), and the row of the table at each.

    The last position is the end of the last pitch; of a whole period it has the first row again.
    """
    pitches, rows = drawn_pitches(database), np.arange(database.position.size)
    if database.period == 1:
        position = np.concatenate([database.position, database.position + 1.0, [2.0]])
        return position, np.concatenate([rows, rows, [0]])
    inside = database.position < pitches
    last = np.searchsorted(database.position, pitches) % database.position.size
    return np.append(database.position[inside], pitches), np.append(rows[inside], last)


def drawn_ste(database: SteDatabase) -> tuple[FloatArray, FloatArray]:
    """Return the positions shown, (n,), and STE there at every load, (n, F) in m.

    A table with failed points cannot be interpolated: it shows its stored points with gaps.
    """
    if database.n_failed:
        m, d = aligned_index(database)
        position, rows = drawn_rows(database)
        return position, database.static_transmission_error[rows][:, :, m, d]
    if database.period > 1:
        pitches = drawn_pitches(database)
        once, values = _interpolated(database, pitches, max(POINTS_PER_PITCH // pitches, _FEWEST_POINTS))
        end = database.ste(float(pitches), database.force, *aligned(database))
        return np.append(once, float(pitches)), np.concatenate([values, end[None]])
    once, values = _interpolated(database, 1, POINTS_PER_PITCH)
    position = np.concatenate([once, once + 1.0, [2.0]])
    return position, np.concatenate([values, values, values[:1]])


def _interpolated(database: SteDatabase, pitches: int, per_pitch: int) -> tuple[FloatArray, FloatArray]:
    """Return dense positions over some pitches, (n,), and STE interpolated at them, (n, F) in m."""
    stored = database.position[database.position < pitches]
    once = np.union1d(np.arange(pitches * per_pitch) / per_pitch, stored)
    return once, database.ste(once[:, None], database.force, *aligned(database))


def load_curve(database: SteDatabase, load: int) -> Curve:
    """Return the curve at a stored load, from the complete rows where points failed."""
    known = _CURVES.setdefault(database, {})
    if load not in known:
        misalignment, change = aligned(database)
        known[load] = database.curve(
            force=float(database.force[load]),
            misalignment=misalignment,
            center_distance_change=change,
            allow_failed=True,
        )
    return known[load]


def drawn_loads(database: SteDatabase) -> tuple[int, ...]:
    """Return the indices of the loads that plots show.

    A table may reach down to a load far below the rest, which serves the extraction near lift-off only.
    """
    level = database.force / database.force[-1]
    return tuple(int(k) for k in range(len(level)) if level[k] > _LIFT_OFF or len(level) == 1)


def mean_over(position: FloatArray, values: FloatArray) -> float:
    """Return the mean of values (n,) over their positions, which may lie unevenly; NaN is left out."""
    step, middle = np.diff(position), 0.5 * (values[1:] + values[:-1])
    known = np.isfinite(middle)
    return float(step[known] @ middle[known] / step[known].sum())


def load_labels(database: SteDatabase) -> tuple[str, ...]:
    """Name every load by its torque on the driving gear."""
    return tuple(f"{label} N m" for label in thousands([float(t) for t in database.torque]))


def few_loads(database: SteDatabase, maximum: int = MAX_LINES) -> tuple[int, ...]:
    """Return the indices of the shown loads, at most `maximum`, nearest to evenly spaced torques."""
    loads = np.array(drawn_loads(database))
    if loads.size <= maximum:
        return drawn_loads(database)
    torque = database.torque[loads]
    even = np.linspace(torque[0], torque[-1], maximum)
    return tuple(int(k) for k in np.unique(loads[np.abs(torque[:, None] - even).argmin(axis=0)]))


def load_lines(
    database: SteDatabase, x: FloatArray, values: FloatArray, bands: FloatArray | None = None
) -> tuple[Line, ...]:
    """Draw `values` (n, F), with error bands if given, as one line for each of a few loads, labeled by it."""
    labels, loads = load_labels(database), few_loads(database)
    names = [labels[k] for k in loads]
    return ordered_lines(x, names, values.T[[*loads]], None if bands is None else bands.T[[*loads]])


def um_of(estimates: Sequence[Estimate]) -> FloatArray:
    """Return values and errors (2, n), µm."""
    return np.asarray(1e6 * np.array([[e.value, e.error] for e in estimates]).T)


def middle_load(database: SteDatabase) -> int:
    """Return the index of the middle one of the loads shown."""
    loads = drawn_loads(database)
    return loads[len(loads) // 2]


def headline_load(database: SteDatabase, force: float | None = None) -> int:
    """Return the index of the stored load nearest to `force` (N), or of the middle load for None."""
    return middle_load(database) if force is None else int(np.argmin(np.abs(database.force - force)))


def pair_count_text(database: SteDatabase, load: int) -> str:
    """Return text on the tooth pairs that carry one load of the aligned pair, as "2 to 4 tooth pairs"."""
    low, high = pair_range(database, load)
    if low == high:
        return f"{low} tooth {'pair carries' if low == 1 else 'pairs carry'} the load at every position"
    joint = "or" if high == low + 1 else "to"
    return f"{low} {joint} {high} tooth pairs carry the load"


def pair_range(database: SteDatabase, load: int) -> tuple[int, int]:
    """Return the least and the largest number of pairs that carry one load of the aligned pair."""
    counts = _counts(database, load)
    return int(counts.min()), int(counts.max())


def _steps_with_pairs(database: SteDatabase, load: int) -> bool:
    """Whether the deflection of a spur pair is smaller where more tooth pairs carry, as drawn."""
    counts = _counts(database, load)
    low, high = counts.min(), counts.max()
    if low == high or database.geometry.base_helix_angle != 0.0:
        return False
    m, d = aligned_index(database)
    ste = database.static_transmission_error[:, load, m, d]
    means = [float(np.nanmean(ste[counts == number])) for number in (low, high)]
    return means[1] < (1.0 - _EQUAL) * means[0]


def _counts(database: SteDatabase, load: int) -> IntArray:
    m, d = aligned_index(database)
    return np.asarray(database.pairs_in_contact[:, load, m, d], dtype=int)


@dataclass(frozen=True)
class HarrisScale:
    """Offset from load to load, and the axis, µm. Harris maps that are compared share one scale."""

    step: float
    axis: Axis

    @classmethod
    def of(cls, *maps: FloatArray) -> HarrisScale:
        """Return the scale on which no curve touches the next.

        `maps` (n, F) are curves less their means in µm, the loads rising.
        """
        ripple = max(float((np.nanmax(curves, axis=0) - np.nanmin(curves, axis=0)).max()) for curves in maps)
        above = max(float(np.nanmax(curves[:, :-1] - curves[:, 1:], initial=0.0)) for curves in maps)
        step = max(_MIN_SPACING * above, _MIN * ripple) or 1.0  # 1 µm if all curves are flat
        drawn = np.concatenate([(curves + step * np.arange(curves.shape[1])).ravel() for curves in maps])
        low, high = float(np.nanmin(drawn)), float(np.nanmax(drawn))
        room = _ROOM * (high - low) or 1.0  # µm, for a single flat curve
        label = f"STE, each load {number(step, 2)} µm higher, µm"
        return cls(step, Axis(label, limits=(low - room, high + room)))


def harris_panel(
    title: str, across: Axis, x: FloatArray, curves: FloatArray, names: Sequence[str], scale: HarrisScale
) -> Panel:
    """Draw the curves (n, F) in µm over `x`, each higher than the last, named at its end."""
    lines = ordered_lines(x, names, (curve + k * scale.step for k, curve in enumerate(curves.T)))
    return Panel(across, scale.axis, lines, title=title)


def ste_curves(database: SteDatabase) -> Figure:
    """Draw STE less its mean at a few loads, and at more of them as a Harris map."""
    curves = [load_curve(database, load) for load in range(database.force.size)]
    ripple, pitches = _ripple(database, curves), drawn_pitches(database)
    panels = (ripple, _harris(database, curves)) if len(drawn_loads(database)) > 1 else (ripple,)
    caption = (
        "STE: displacement on the transverse line of action by which the driven gear lags, relative to "
        f"conjugate motion; drawn less its mean. {_bands(ripple)}{_carriers(database)}"
    )
    if database.period > 1:
        caption += f" The teeth differ: the curve repeats after {database.period} base pitches."
    return Figure(
        key="ste",
        title=f"Static transmission error over {'two' if pitches == 2 else pitches} base pitches",
        caption=caption,
        alternative=_alternative(database, curves),
        content=panels,
        table=_table(database, curves),
    )


def _ripple(database: SteDatabase, curves: list[Curve]) -> Panel:
    position, ripple = _less_mean(database, curves)
    lines = tuple(
        # the band is half the error, in µm: on either side of the curve
        replace(line, label=_label(line, curves[load]), band=0.5e6 * curves[load].peak_to_peak.error)
        for line, load in zip(load_lines(database, position, ripple), few_loads(database), strict=True)
    )
    values = np.concatenate([line.y for line in lines])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    height = high - low or _FLAT
    room = np.clip(
        max(float(np.nan_to_num(line.band)) for line in lines), _MIN_ROOM * height, _MAX_ROOM * height
    )
    return Panel(
        position_axis(database),
        Axis("STE less its mean, µm", limits=(low - float(room), high + float(room))),
        lines,
        title="Ripple",
    )


def _label(line: Line, curve: Curve) -> str:
    mean, ripple = (to_error(1e6 * e.value, 1e6 * e.error) for e in (curve.mean, curve.peak_to_peak))
    return f"{line.name}: mean {mean} µm\n{ripple} µm peak to peak"


def _harris(database: SteDatabase, curves: list[Curve]) -> Panel:
    position, ripple = _less_mean(database, curves)
    loads, labels = few_loads(database, MAX_CURVES), load_labels(database)
    chosen, names = ripple[:, loads], [labels[k] for k in loads]
    return harris_panel(
        "Harris map", position_axis(database), position, chosen, names, HarrisScale.of(chosen)
    )


def _less_mean(database: SteDatabase, curves: list[Curve]) -> tuple[FloatArray, FloatArray]:
    """Return the positions shown (n,), and STE there less the mean of each load (n, F), µm."""
    position, values = drawn_ste(database)
    return position, 1e6 * (values - np.array([curve.mean.value for curve in curves]))


def _bands(ripple: Panel) -> str:
    """Return a sentence on the error bands, if any, and on cut bands."""
    if not any(line.has_band for line in ripple.lines):
        return ""
    sentence = "Bands: half the error of peak-to-peak on either side"
    low, high = ripple.y.limits or (-np.inf, np.inf)
    cut = [
        line.name
        for line in ripple.lines
        if np.nanmax(line.y + line.band) > high or np.nanmin(line.y - line.band) < low
    ]
    return f"{sentence}, cut by the axis at {', '.join(cut)}. " if cut else f"{sentence}. "


def _carriers(database: SteDatabase) -> str:
    load = drawn_loads(database)[-1]
    carried = f"At {load_labels(database)[load]} {pair_count_text(database, load)}"
    return (
        f"{carried}: low where more do, high where fewer."
        if _steps_with_pairs(database, load)
        else f"{carried}."
    )


def _alternative(database: SteDatabase, curves: list[Curve]) -> str:
    labels, loads = load_labels(database), drawn_loads(database)
    ends = {labels[k]: curves[k] for k in (loads[-1], loads[0])}
    parts = [
        f"{_band(curve.peak_to_peak)} µm at {label}, about a mean of {um(curve.mean.value, 3)} µm"
        for label, curve in ends.items()
    ]
    return f"Peak to peak is {'; '.join(parts)}."


def _table(database: SteDatabase, curves: list[Curve]) -> Table:
    """Mean, peak to peak and the first harmonics with their error estimates at every load."""
    rows = []
    for load, (label, curve) in enumerate(zip(load_labels(database), curves, strict=True)):
        band = [_band(e) for e in (curve.mean, curve.peak_to_peak)]
        tones = [um(e.value, 3) for e in curve.harmonics[:_TONES]]
        rows.append((label, number(database.force[load], 5), *band, *tones))
    head = ("torque", "normal force, N", "mean, µm", "peak to peak, µm")
    orders = tuple(f"harmonic {k}, µm" for k in range(1, _TONES + 1))
    return Table("Static transmission error by load", head + orders, tuple(rows))


def _band(estimate: Estimate) -> str:
    """Write a number in micrometers, with its error if that was estimated."""
    return with_error(estimate.value / UM, estimate.error / UM)
