"""A housing by its mesh: seats, feet, points, material, and the damping of its modes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from bounds import Quantity, Text, declared, described, required
from dynamics.checks import declared_fields, distinct, within
from dynamics.errors import InputError
from dynamics.housings.supports import Foot, SeatBore
from dynamics.housings.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import LOSS_FACTOR, MODES, Material
from dynamics.types import FloatArray, IntArray

HIGHEST_RATIO = 1.0  # largest damping ratio of a mode: critical damping
CORNERS = 4  # corners of a tetrahedron, its first nodes; middles of edges follow
RIGID_MODES = 6  # rigid-body modes of a housing without feet


class _Damping(Protocol):
    """A law of the damping ratios of modes."""

    def ratios(self, elastic_share: FloatArray) -> FloatArray:
        """Return the damping ratios of modes by the housing's share of their strain energy."""


@dataclass(frozen=True)
class ModalDamping:
    """A damping ratio for each mode by rising frequency; the last one holds for all further modes."""

    ratio: tuple[float, ...]

    def __post_init__(self) -> None:
        if not self.ratio:
            raise InputError("ratio", self.ratio, "at least one number")
        for index, value in enumerate(self.ratio):
            within(f"ratio[{index}]", value, 0.0, HIGHEST_RATIO)

    def ratios(self, elastic_share: FloatArray) -> FloatArray:
        """Return the ratios; that of a mode without strain energy is 0."""
        number = np.minimum(np.arange(len(elastic_share)), len(self.ratio) - 1)
        return np.where(elastic_share > 0.0, np.array(self.ratio)[number], 0.0)


@described
@dataclass(frozen=True)
class MaterialDamping:
    """Half the loss factor is the damping ratio of a mode whose strain energy is all in the housing.

    This is the equivalent viscous damping: at the natural frequency of a mode it loses as much energy as the
    material.
    """

    loss_factor: float = required(LOSS_FACTOR)

    def __post_init__(self) -> None:
        declared_fields(self)

    def ratios(self, elastic_share: FloatArray) -> FloatArray:
        """Return the ratios; energy in mounts is not lost by the material."""
        return 0.5 * self.loss_factor * elastic_share


USUAL_DAMPING = MaterialDamping(0.01)
"""Cast iron with bolted joints: a guess, 0.004 to 0.02."""


@dataclass(frozen=True)
class MeshedHousing:
    """A housing of one material, with bearing seats, feet and points of interest."""

    mesh: TetrahedralMesh
    material: Material
    seats: tuple[SeatBore, ...]
    feet: tuple[Foot, ...] = ()
    """Feet; a housing without feet is free, and its reduction has six rigid-body modes besides `modes`."""
    points: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    """Points, m, by name, whose motion is computed: that of the nearest node."""
    modes: int = declared(80, MODES)
    damping: _Damping = USUAL_DAMPING
    """Default: `USUAL_DAMPING`."""

    def __post_init__(self) -> None:
        declared_fields(self)
        if not self.seats:
            remedy = "A housing acts through its bearing seats."
            raise InputError("seats", self.seats, "at least one seat", remedy)
        distinct("seats", [seat.name for seat in self.seats])
        distinct("feet", [foot.name for foot in self.feet])
        # columns of the reduced matrices; their number must be well below that of the mesh
        columns = RIGID_MODES + sum(seat.motions for seat in self.seats)
        if self.modes + columns >= self.mesh.freedoms // 2:
            bound = "below half the freedoms of the mesh"
            raise InputError("modes", self.modes, bound, f"It has {self.mesh.freedoms}: refine it.")

    def nodes_of_points(self) -> IntArray:
        """Return the indices of the nodes nearest to the points.

        Raises `InputError`: a point is farther from all nodes than the longest edge of an element.
        """
        corner = self.mesh.points[self.mesh.tetrahedra[:, :CORNERS]]
        # four of the six edges of each element, which are enough for the longest one of a mesh
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
