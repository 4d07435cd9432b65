"""The coast flank: the other side of the teeth, which touches when backlash is used up.

Turned by pi about the line of centers, a pair that is pushed on its coast flanks looks like the same pair
driven in the other sense: hands stay, and the force law is the driving flank's as long as teeth are alike on
both sides. What changes is the position: the driver's coast flank passes the pitch point when the driver has
turned on by its tooth's thickness from where the drive flank passed. With x the position of the driving
flank and c that thickness over the pitch, both on the operating pitch circle, the coast flank is at c - x.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.checks import finite, not_negative
from dynamics.meshes.mesh_table import DERIVATIVES, LEVERS, MeshTable, check_table
from dynamics.meshes.technique import PlainTable
from dynamics.types import FloatArray


@dataclass(frozen=True)
class CoastFlank:
    """Contact on the coast flanks.

    Attributes
    ----------
    backlash : float
        m, >= 0, along the transverse line of action (an arc of the base circles), at the scene's center
        distance; 0 is that of nominal gears.
    thickness : float
        Thickness of the driver's teeth over the pitch, both on the operating pitch circle.
    table : MeshTable or None
        Of the pair driven on its coast flanks, positions counted in the driver's sense then, 0 where the
        reference pair touches at the pitch point, faces seen from the other end. None: that of the driving
        flank, which assumes symmetric teeth, modifications included.
    """

    backlash: float
    thickness: float = 0.5
    table: MeshTable | None = None

    def __post_init__(self) -> None:
        not_negative("backlash", self.backlash)
        finite("thickness", self.thickness)
        if self.table is not None:
            check_table("table", self.table)


def mirrored(table: MeshTable, thickness: float) -> PlainTable:
    """Return `table` with its positions x replaced by thickness - x, at the same forces and deflections."""
    position = np.mod(thickness - table.position, float(table.period))
    position[position >= table.period] = 0.0  # a tiny negative one rounds up to a whole period
    order = np.argsort(position)

    def turned(values: FloatArray) -> FloatArray:
        return np.ascontiguousarray(np.take(values, order, axis=-2))

    return PlainTable(
        position[order],
        table.level,
        table.misalignment,
        table.center_distance_change,
        turned(table.deflection),
        -turned(table.deflection_slope),
        turned(table.stiffness),
        -turned(table.stiffness_slope),
        table.period,
        **{name: turned(values) for name in LEVERS if (values := getattr(table, name, None)) is not None},
        **{
            name: np.array([1.0, -1.0]).reshape(2, 1, 1, 1, 1) * turned(values)
            for name in DERIVATIVES
            if (values := getattr(table, name, None)) is not None
        },
    )
