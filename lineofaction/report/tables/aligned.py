"""The slice of a database that plots show: no misalignment, nominal center distance, some base pitches."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fe_contact.ste import Curve, SteDatabase
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, FloatArray, Line, thousands

POINTS_PER_PITCH = 240
POSITION_LABEL = "position of the driving gear, base pitches (0 = reference pair at the pitch point)"
MOST_PITCHES = 40  # of a long period
MOST_LINES = 5  # of loads in one panel
_FEWEST_POINTS = 32
_LIFT_OFF = 0.002  # loads up to this part of the largest serve lift-off


def aligned_index(database: SteDatabase) -> tuple[int, int]:
    """Return the indices on the misalignment and center-distance axes nearest to zero."""
    axes = (database.misalignment, database.center_distance_change)
    return int(np.argmin(np.abs(axes[0]))), int(np.argmin(np.abs(axes[1])))


def aligned(database: SteDatabase) -> tuple[float, float]:
    """Return the misalignment and center-distance change (m) that plots show."""
    m, d = aligned_index(database)
    return float(database.misalignment[m]), float(database.center_distance_change[d])


def pitches_shown(database: SteDatabase) -> int:
    """Return how many base pitches plots show: two, or a longer period up to its first 40."""
    return 2 if database.period == 1 else min(database.period, MOST_PITCHES)


def position_axis(database: SteDatabase) -> Axis:
    """Return the axis of the positions shown."""
    return Axis(POSITION_LABEL, limits=(0, pitches_shown(database)))


def shown_rows(database: SteDatabase) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return the positions shown, (n,), and the row of the table that holds each; the last closes them."""
    shown, rows = pitches_shown(database), np.arange(database.position.size)
    if database.period == 1:
        position = np.concatenate([database.position, database.position + 1.0, [2.0]])
        return position, np.concatenate([rows, rows, [0]])
    inside = database.position < shown
    last = np.searchsorted(database.position, shown) % database.position.size
    return np.append(database.position[inside], shown), np.append(rows[inside], last)


def ste_shown(database: SteDatabase) -> tuple[FloatArray, FloatArray]:
    """Return the positions shown, (n,), and STE there at every load, (n, F) in m.

    A table with failed points cannot be interpolated: it shows its stored points with gaps.
    """
    if database.n_failed:
        m, d = aligned_index(database)
        position, rows = shown_rows(database)
        return position, database.static_transmission_error[rows][:, :, m, d]
    if database.period > 1:
        return _over_long_period(database)
    once, values = _interpolated(database, 1, POINTS_PER_PITCH)
    position = np.concatenate([once, once + 1.0, [2.0]])
    return position, np.concatenate([values, values, values[:1]])


def _over_long_period(database: SteDatabase) -> tuple[FloatArray, FloatArray]:
    """Return the first pitches of a long period with their end."""
    shown = pitches_shown(database)
    once, values = _interpolated(database, shown, max(POINTS_PER_PITCH // shown, _FEWEST_POINTS))
    end = database.ste(float(shown), database.force, *aligned(database))
    return np.append(once, float(shown)), np.concatenate([values, end[None]])


def _interpolated(database: SteDatabase, pitches: int, per_pitch: int) -> tuple[FloatArray, FloatArray]:
    """Return some pitches, densely, as the table's users see them."""
    stored = database.position[database.position < pitches]
    once = np.union1d(np.arange(pitches * per_pitch) / per_pitch, stored)
    return once, database.ste(once[:, None], database.force, *aligned(database))


def load_curve(database: SteDatabase, load: int) -> Curve:
    """Return the curve at a stored load, from the complete rows where points failed."""
    misalignment, change = aligned(database)
    return database.curve(
        force=float(database.force[load]),
        misalignment=misalignment,
        center_distance_change=change,
        allow_failed=True,
    )


def shown_loads(database: SteDatabase) -> tuple[int, ...]:
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


def few_loads(database: SteDatabase, most: int = MOST_LINES) -> tuple[int, ...]:
    """Return the indices of the loads shown; of more than `most` those nearest to evenly spaced torques."""
    loads = np.array(shown_loads(database))
    if loads.size <= most:
        return shown_loads(database)
    torque = database.torque[loads]
    even = np.linspace(torque[0], torque[-1], most)
    return tuple(int(k) for k in np.unique(loads[np.abs(torque[:, None] - even).argmin(axis=0)]))


def load_lines(database: SteDatabase, x: FloatArray, values: FloatArray) -> tuple[Line, ...]:
    """Draw `values` (n, F) as one line for each of a few loads, dark for the smallest, labeled by it."""
    labels, loads = load_labels(database), few_loads(database)
    return tuple(
        Line(labels[k], x, values[:, k], palette.ordered(step, len(loads)), label=labels[k])
        for step, k in enumerate(loads)
    )


def middle_load(database: SteDatabase) -> int:
    """Return the index of the middle one of the loads shown."""
    loads = shown_loads(database)
    return loads[len(loads) // 2]


def headline_load(database: SteDatabase, force: float | None = None) -> int:
    """Return the index of the stored load nearest to `force` (N); None: of the middle one."""
    return middle_load(database) if force is None else int(np.argmin(np.abs(database.force - force)))
