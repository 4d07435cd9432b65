"""How a row of rolling elements is laid out for compiled functions."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.bearings.roller_bearing import BOTH


@dataclass(frozen=True)
class RowPlacement:
    """What a row's geometry does not say.

    Attributes
    ----------
    copies : int
        Each element as so many that share its stiffness, evenly spaced: more than 1 averages its passing.
    lever : float
        Length that makes coordinates of tilts, m; 1: coordinates are in rad and moments in N m.
    shift : float
        Displacement of the inner ring along z, less that of the outer, at which the coordinates are 0, m.
    damping : float
        Damping of an element over its load, s/m.
    locating : str
        Directions in which the rings are held in their seats, see `dynamics.bearings.roller_bearing`.
    """

    copies: int = 1
    lever: float = 1.0
    shift: float = 0.0
    damping: float = 0.0
    locating: str = BOTH
