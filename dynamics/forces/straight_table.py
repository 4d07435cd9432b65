"""A mesh-force table of constant stiffness."""

from __future__ import annotations

import numpy as np

from dynamics.checks import positive
from dynamics.forces.technique import PlainTable


def straight_table(stiffness: float, level: float = 1e3) -> PlainTable:
    """Return the table of a flank of the same stiffness at all positions: F = stiffness d, in contact only.

    Parameters
    ----------
    stiffness : float
        Along the transverse line of action, N/m.
    level : float
        Force of the table's second level, N; beyond it the table goes on straight.

    Raises
    ------
    InputError
        If either is not above 0.
    """
    positive("stiffness", stiffness)
    positive("level", level)
    position, levels = np.array([0.0, 0.5]), np.array([0.0, level])
    deflection = np.broadcast_to(levels / stiffness, (1, 1, 2, 2)).copy()
    flat = np.zeros_like(deflection)
    return PlainTable(
        position,
        levels,
        np.zeros(1),
        np.zeros(1),
        deflection,
        flat,
        np.full_like(deflection, stiffness),
        flat.copy(),
    )
