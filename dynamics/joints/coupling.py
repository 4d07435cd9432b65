"""A flexible coupling between two shafts: a torsional spring, or a full linear one."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, above, between, declared, described, required
from dynamics.bearings.matrix import Matrix, check_matrix
from dynamics.checks import declared_fields
from dynamics.errors import InputError

_TORSION = "Torsional stiffness; 0 beside a matrix without rotation: a bearing between two shafts"
_STIFFNESS = Declared(Kind.STIFFNESS, "N m/rad", between(0.0, 1e15), _TORSION, 5e4)
_DAMPING = Declared(Kind.DAMPING, "N m s/rad", between(0.0, 1e12), "Torsional damping", 5.0)
_POSITION = Declared(
    Kind.LENGTH,
    "m",
    between(-1000.0, 1000.0),
    "Position along the first shaft, from its left end, for the matrices and for torsion of flexible shafts",
    0.2,
)


@described
@dataclass(frozen=True)
class Coupling:
    """A massless spring and damper between a point of one shaft and the same point of another.

    Both shafts turn at the same mean speed, unless it has no torsional stiffness: a bearing between two
    shafts, which holds them across and along the axis and leaves their rotations free. The force on `second`
    is -K (motion of second - motion of first), with the motion (x, y, z, tilt_x, tilt_y, rotation) of both
    rigid shafts at the coupling.

    The 6 by 6 matrices `stiffness` and `damping` are added to the torsional ones: symmetric, positive
    semidefinite, in N, m, rad, s; for coaxial shafts. In a carrier's frame, and between shafts of different
    frames, they must be isotropic across the axis. Rates across frames are those seen in the fixed frame, or
    in that of `first`.
    """

    name: str
    first: str
    second: str
    torsional_stiffness: float = required(_STIFFNESS)
    torsional_damping: float = declared(0.0, _DAMPING)
    position: float = declared(0.0, _POSITION)
    stiffness: Matrix | None = None
    damping: Matrix | None = None

    def __post_init__(self) -> None:
        declared_fields(self)
        for name in ("stiffness", "damping"):
            if getattr(self, name) is not None:
                check_matrix(name, getattr(self, name), (6,))
        if self.first == self.second:
            raise InputError("second", self.second, "another shaft than the first")
        if self.torsional_stiffness == 0.0 and self.stiffness is None:
            suggestion = "Or give the matrix of a bearing between shafts that turn at speeds of their own."
            raise InputError("torsional_stiffness", 0.0, above(0.0), suggestion)

    @property
    def joins_rotations(self) -> bool:
        """Whether both shafts turn at the same mean speed."""
        return self.torsional_stiffness > 0.0 or (self.stiffness is not None and self.stiffness[5][5] > 0.0)
