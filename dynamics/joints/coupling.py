"""A flexible coupling between two shafts: a torsional spring, or a full linear one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import above
from dynamics.checks import finite, not_negative
from dynamics.errors import InputError
from dynamics.joints.matrix import Matrix, check_matrix


@dataclass(frozen=True)
class Coupling:
    """A massless spring and damper between a point of one shaft and the same point of another.

    Both shafts turn at the same mean speed. The force on `second` is -K (motion of second - motion of first),
    with the motion (x, y, z, tilt_x, tilt_y, rotation) of both rigid shafts at the coupling.

    Attributes
    ----------
    name : str
        Unique among the couplings.
    first, second : str
        The shafts.
    torsional_stiffness, torsional_damping : float
        N m/rad, N m s/rad about the axis; >= 0.
    position : float
        Of the coupling along the first shaft, m from its left end; for the matrices.
    stiffness, damping : 6 by 6 matrices or None
        Added to the torsional ones: symmetric, positive semidefinite, in N, m, rad, s; for coaxial shafts. In
        a carrier's frame, and between shafts of different frames, they must be the same in all directions
        across the axis. Rates across frames are those seen in the fixed one, or in that of `first`.
    """

    name: str
    first: str
    second: str
    torsional_stiffness: float
    torsional_damping: float = 0.0
    position: float = 0.0
    stiffness: Matrix | None = None
    damping: Matrix | None = None

    def __post_init__(self) -> None:
        not_negative("torsional_stiffness", self.torsional_stiffness)
        not_negative("torsional_damping", self.torsional_damping)
        finite("position", self.position)
        for name in ("stiffness", "damping"):
            if getattr(self, name) is not None:
                check_matrix(name, np.asarray(getattr(self, name), dtype=float), (6,))
        if self.first == self.second:
            raise InputError("second", self.second, "another shaft than the first")
        if self.torsional_stiffness == 0.0 and (self.stiffness is None or self.stiffness[5][5] <= 0.0):
            suggestion = "Without it the shafts would not turn together."
            raise InputError("torsional_stiffness", 0.0, above(0.0), suggestion)
