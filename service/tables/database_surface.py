"""The database as a surface: position, force, static transmission error."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase
from service.drawing.figure import Axis, Figure, FloatArray, Surface, number
from service.tables.aligned import aligned, ste_shown
from service.tables.pairs_in_contact import pairs_in_words, steps_with_pairs

_COLUMNS, _ROWS = 160, 60


def database_surface(database: SteDatabase) -> Figure:
    """Draw STE over position and normal force."""
    axes = (Axis("position, base pitches"), Axis("normal force, N"), Axis("STE, µm"))
    position, force, values = surface(database)
    highest = database.force.size - 1
    step = ", with a step at each change of their number" if steps_with_pairs(database, highest) else ""
    top, load = number(1e6 * float(np.nanmax(values)), 3), number(float(force[-1]), 5)
    return Figure(
        key="database",
        title="The STE database",
        caption="What passes to dynamics: transmission error over the driving gear's position and the "
        "tooth force. The mesh force at a deflection is read from this surface.",
        alternative=f"A surface that rises with force, from zero to {top} µm at {load} N. "
        f"There {pairs_in_words(database, highest)}{step}.",
        content=Surface(position, force, 1e6 * values, axes),
    )


def surface(database: SteDatabase) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return positions (n,), normal forces (m,) and STE (m, n) in m; with failed points, as stored."""
    position, values = ste_shown(database)
    step = max(len(position) // _COLUMNS, 1)
    if database.n_failed:
        return position[::step], database.force, values[::step].T
    force = np.linspace(float(database.force[0]), float(database.force[-1]), _ROWS)
    misalignment, change = aligned(database)
    return position[::step], force, database.ste(position[::step], force[:, None], misalignment, change)
