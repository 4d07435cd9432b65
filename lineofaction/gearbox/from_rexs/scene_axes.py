"""The axes of the scene: z along the shafts, x and y along v and w of the gear unit."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.placement import FIXED, PARALLEL, Placement


@dataclass(frozen=True)
class SceneAxes:
    """The frame of the scene.

    `rows` (3, 3): unit vectors x, y, z of the scene in the frame of the model.
    """

    rows: FloatArray

    @classmethod
    def of(cls, root: Placement | None, shafts: Iterable[Placement]) -> SceneAxes:
        """Return the axes for shafts that are parallel to the first of them.

        The gear unit's u is z if the first shaft is parallel to it, in either sense; else the first shaft's u
        is z. `root` is the placement of the gear unit.
        """
        unit = root or FIXED
        first = next(iter(shafts), unit)
        parallel = float(np.linalg.norm(np.cross(unit.axes[0], first.axes[0]))) <= PARALLEL
        u, v, w = unit.axes if parallel else first.axes
        return cls(np.array([v, w, u]))

    def point(self, origin: FloatArray) -> FloatArray:
        """Return a point of the model in x, y, z, m."""
        return np.asarray(self.rows @ origin)

    def sense(self, placement: Placement) -> int:
        """Return +1 where u of a place is along z, -1 where it is against it, 0 where it is neither."""
        across = float(np.linalg.norm(np.cross(self.rows[2], placement.axes[0])))
        if across > PARALLEL:
            return 0
        return 1 if self.rows[2] @ placement.axes[0] > 0.0 else -1

    def rotation(self, placement: Placement) -> FloatArray:
        """Return the matrix that takes u, v, w of a place to x, y, z."""
        return np.asarray(self.rows @ placement.axes.T)
