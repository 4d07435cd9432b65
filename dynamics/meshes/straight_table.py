"""A mesh-force table of constant stiffness."""

from __future__ import annotations

from dynamics.checks import positive
from dynamics.meshes.stiffness_table import PeriodicCurve, stiffness_table
from dynamics.meshes.technique import PlainTable


def straight_table(stiffness: float) -> PlainTable:
    """Return the table of a flank of the same stiffness at all positions: F = stiffness d, in contact only.

    Parameters
    ----------
    stiffness : float
        Along the transverse line of action, N/m.

    Raises
    ------
    InputError
        If it is not above 0.
    """
    return stiffness_table(PeriodicCurve.constant(positive("stiffness", stiffness)))
