"""The database as a surface: position, force, static transmission error."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase
from service.report.aligned import two_pitches
from service.report.figure import Axis, Figure, Surface, number

_COLUMNS = 160


def database_surface(database: SteDatabase) -> Figure:
    """Draw STE over position and normal force."""
    position, values = two_pitches(database)
    step = max(len(position) // _COLUMNS, 1)
    axes = (Axis("position, base pitches"), Axis("normal force, N"), Axis("STE, µm"))
    surface = Surface(position[::step], database.force, values[::step].T * 1e6, axes)
    top = number(float(np.nanmax(values)) * 1e6, 3)
    load = number(float(database.force[-1]), 5)
    load = number(float(database.force[-1]), 5)
    return Figure(
        key="database",
        title="The STE database",
        caption="What passes to dynamics: transmission error over the driving gear's position and the "
        "tooth force. The mesh force at a deflection is read from this surface.",
        alternative=f"A surface that rises with force, from zero to {top} µm at {load} N, "
        "with a step at each change between single and double contact.",
        content=surface,
    )
