"""A mesh-force table at one operating point, by the same cubic pieces as the compiled look-up."""

from __future__ import annotations

import numpy as np

from dynamics.meshes.mesh_table import MeshTable
from dynamics.meshes.technique import PlainTable
from dynamics.types import FloatArray


def table_at_operating_point(
    table: MeshTable, misalignment: float, center_distance_change: float
) -> PlainTable:
    """Return `table` at one misalignment and center-distance change in m; ends are held beyond the axes.

    Needs the table's derivatives along axes of more than one knot.
    """
    m = _weights(np.asarray(table.misalignment, dtype=float), misalignment)
    a = _weights(np.asarray(table.center_distance_change, dtype=float), center_distance_change)

    def here(name: str, order: int) -> FloatArray:
        derivative = getattr(table, f"{name}_derivative", None)
        if derivative is None:
            return np.asarray(getattr(table, name if order == 0 else f"{name}_slope"), dtype=float)
        values = np.einsum("um,vd,uvmdpl->pl", m, a, np.asarray(derivative, dtype=float)[:, :, order])
        return np.asarray(values[None, None])

    return PlainTable(
        np.asarray(table.position, dtype=float),
        np.asarray(table.level, dtype=float),
        np.array([misalignment]),
        np.array([center_distance_change]),
        here("deflection", 0),
        here("deflection", 1),
        here("stiffness", 0),
        here("stiffness", 1),
        table.period,
    )


def _weights(knots: FloatArray, at: float) -> FloatArray:
    """Hermite weights of the values and the slopes at all `knots` (k,), (2, k)."""
    weight = np.zeros((2, knots.size))
    if knots.size == 1:
        weight[0, 0] = 1.0
        return weight
    left = int(np.clip(np.searchsorted(knots, at, side="right") - 1, 0, knots.size - 2))
    width = knots[left + 1] - knots[left]
    u = float(np.clip((at - knots[left]) / width, 0.0, 1.0))
    s = 1.0 - u
    weight[:, left] = (1.0 + 2.0 * u) * s * s, width * u * s * s
    weight[:, left + 1] = u * u * (3.0 - 2.0 * u), -width * u * u * s
    return weight
