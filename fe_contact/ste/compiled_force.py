"""An STE database made ready for many force queries a second."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fe_contact.ste.extraction import force_table
from fe_contact.ste.fields import SteFields
from fe_contact.ste.force_kernels import KernelTable, sample_forces
from fe_contact.ste.interpolation import Axis
from fe_contact.ste.level_grid import LevelGrid
from fe_contact.ste.mesh_force import MeshForce
from fe_contact.types import FloatArray


class _Forces(NamedTuple):
    """Transverse mesh force F_bt (N), stiffness dF/d(deflection) (N/m), sums of `Validity` flags, (n,)."""

    force: FloatArray
    stiffness: FloatArray
    validity: NDArray[np.int8]


@dataclass(frozen=True)
class CompiledForce:
    """`SteDatabase.force_at` without the position slope, compiled: the same numbers to the last bit."""

    table: KernelTable

    @classmethod
    def of(cls, database: SteFields) -> CompiledForce:
        """Return the compiled form of a database; raises as `extraction.force_table`."""
        law = MeshForce(force_table(database))
        orders = [
            [once for axis, once in zip(law.axes, order, strict=True) if len(axis.knots) > 1]
            for order in law.levels.nodal
        ]
        size = np.array([axis.knots.size for axis in law.axes])
        table = KernelTable(
            knots=np.concatenate([axis.knots for axis in law.axes]),
            spacing=np.concatenate([_widths(axis) for axis in law.axes]),
            first=np.cumsum(size) - size,
            size=size,
            period=law.axes[0].period,
            level=np.array(law.table.level),
            deflection=_packed(law.levels),
            stiffness=_packed(law.stiffnesses),
            order=np.array(orders, dtype=np.int64).reshape(len(orders), -1),
        )
        return cls(table)

    def force_at(self, points: FloatArray) -> _Forces:
        """Evaluate at `points` (4, n): position, misalignment, change of center distance, deflection.

        Positions in base pitches, lengths in m, all finite, which the caller has checked. The GIL is free
        meanwhile.
        """
        size = points.shape[1]
        forces = _Forces(np.empty(size), np.empty(size), np.empty(size, np.int8))
        sample_forces(self.table, points, *forces)
        return forces


def _widths(axis: Axis) -> FloatArray:
    """Return the width of the interval that begins at each knot; 1 where none does."""
    missing = axis.knots.size - axis.spacing.size
    return np.concatenate([axis.spacing, np.ones(missing)])


def _packed(grid: LevelGrid) -> FloatArray:
    return np.ascontiguousarray(np.stack(list(grid.nodal.values()), axis=-1)).ravel()
