"""A housing by its mesh: what is reduced."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from bounds import Quantity, Text, declared
from dynamics.checks import declared_fields, distinct
from dynamics.errors import InputError
from dynamics.housing_modes.damping import USUAL_DAMPING, Damping
from dynamics.housing_modes.feet import Foot
from dynamics.housing_modes.seats import SeatBore, check_seats
from dynamics.housing_modes.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import MODES, Material
from dynamics.types import IntArray


@dataclass(frozen=True)
class MeshedHousing:
    """A housing of one material, with bearing seats, feet and points of interest.

    Attributes
    ----------
    mesh : TetrahedralMesh
    material : Material
    seats : tuple of SeatBore
    feet : tuple of Foot
        Without any the housing is free, and six rigid-body modes are kept besides `modes`.
    points : mapping of str to (x, y, z)
        m; the motion of the node next to each is recovered.
    modes : int
    damping : Damping
        Default: `USUAL_DAMPING`.
    """

    mesh: TetrahedralMesh
    material: Material
    seats: tuple[SeatBore, ...]
    feet: tuple[Foot, ...] = ()
    points: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    modes: int = declared(80, MODES)
    damping: Damping = USUAL_DAMPING

    def __post_init__(self) -> None:
        declared_fields(self)
        check_seats(self.seats)
        distinct("feet", [foot.name for foot in self.feet])
        columns = 6 + sum(seat.motions for seat in self.seats)
        if self.modes + columns >= self.mesh.freedoms // 2:
            bound = "below half the freedoms of the mesh"
            raise InputError("modes", self.modes, bound, f"It has {self.mesh.freedoms}: refine it.")

    def nodes_of_points(self) -> IntArray:
        """Return the nodes next to the points.

        Raises
        ------
        InputError
            A point is farther from all nodes than the longest edge of an element.
        """
        corner = self.mesh.points[self.mesh.tetrahedra[:, :4]]
        reach = float(np.max(np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2)))
        nodes = []
        for name, point in self.points.items():
            distance = np.linalg.norm(self.mesh.points - np.array(point, dtype=float), axis=1)
            if not distance.min() <= reach:
                away = Quantity(float(distance.min()), "m", digits=6)
                bound = Text.of("within an element of the mesh; the next node is ", away, " away")
                raise InputError(f"points.{name}", point, bound)
            nodes.append(int(distance.argmin()))
        return np.array(nodes, dtype=np.int64)
