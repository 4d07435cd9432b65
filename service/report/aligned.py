"""The slice of a database that plots show: no misalignment, nominal centre distance, two base pitches."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import Curve, SteDatabase
from service.report import palette
from service.report.figure import FloatArray, Line, thousands

POINTS_PER_PITCH = 240
_LIFT_OFF = 0.002  # loads up to this part of the largest serve lift-off


def aligned_index(database: SteDatabase) -> tuple[int, int]:
    """Return the indices on the misalignment and centre-distance axes nearest to zero."""
    axes = (database.misalignment, database.center_distance_change)
    return int(np.argmin(np.abs(axes[0]))), int(np.argmin(np.abs(axes[1])))


def aligned(database: SteDatabase) -> tuple[float, float]:
    """Return the misalignment and centre-distance change (m) that plots show."""
    m, d = aligned_index(database)
    return float(database.misalignment[m]), float(database.center_distance_change[d])


def two_pitches(database: SteDatabase) -> tuple[FloatArray, FloatArray]:
    """Return positions from 0 to 2 base pitches, (n,), and STE there at every load, (n, F) in m.

    A table with failed points cannot be interpolated: it shows its stored points with gaps.
    """
    once, values = _stored(database) if database.n_failed else _interpolated(database)
    position = np.concatenate([once, once + 1.0, [2.0]])
    return position, np.concatenate([values, values, values[:1]])


def _interpolated(database: SteDatabase) -> tuple[FloatArray, FloatArray]:
    """One pitch, densely, as the table's users see it."""
    misalignment, change = aligned(database)
    once = np.union1d(np.arange(POINTS_PER_PITCH) / POINTS_PER_PITCH, database.position)
    return once, database.ste(once[:, None], database.force, misalignment, change)


def _stored(database: SteDatabase) -> tuple[FloatArray, FloatArray]:
    """One pitch at the stored positions."""
    m, d = aligned_index(database)
    return database.position, database.static_transmission_error[:, :, m, d]


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


def load_labels(database: SteDatabase) -> tuple[str, ...]:
    """Name every load by its torque on the driving gear."""
    return tuple(f"{label} N m" for label in thousands([float(t) for t in database.torque]))


def load_lines(database: SteDatabase, position: FloatArray, values: FloatArray) -> tuple[Line, ...]:
    """Draw `values` (n, F) as one line per load shown, dark for the smallest."""
    labels, loads = load_labels(database), shown_loads(database)
    colours = (palette.ordered(step, len(loads)) for step in range(len(loads)))
    return tuple(
        Line(labels[k], position, values[:, k], colour) for k, colour in zip(loads, colours, strict=True)
    )


def middle_load(database: SteDatabase) -> int:
    """Return the index of the middle one of the loads shown."""
    loads = shown_loads(database)
    return loads[len(loads) // 2]


def headline_load(database: SteDatabase, force: float | None = None) -> int:
    """Return the index of the stored load nearest to `force` (N); None: of the middle one."""
    return middle_load(database) if force is None else int(np.argmin(np.abs(database.force - force)))
