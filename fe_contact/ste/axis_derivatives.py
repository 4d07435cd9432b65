"""The derivatives along all axes of a mesh-force table: plain arrays that make it C1 in every coordinate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.ste.force_table import ForceTable
from fe_contact.ste.level_grid import LevelGrid
from fe_contact.ste.mesh_force import MeshForce
from fe_contact.types import FloatArray


def with_axis_derivatives(mesh_force: MeshForce) -> ForceTable:
    """Return the table of `mesh_force` with the derivatives that its interpolant uses.

    Stiffnesses come limited over all axes jointly, so that the force never falls with deflection; a table
    with one knot of misalignment and of center distance is returned as it is.
    """
    table = mesh_force.table
    if table.misalignment.size == 1 and table.center_distance_change.size == 1:
        return table
    return replace(
        table,
        deflection_derivative=_by_order(mesh_force.levels),
        stiffness_derivative=_by_order(mesh_force.stiffnesses),
    )


def _by_order(grid: LevelGrid) -> FloatArray:
    """Numbers of a grid over position, misalignment, center distance as (2, 2, 2, M, D, P, L)."""
    shape = np.moveaxis(grid.nodal[(0, 0, 0)], 0, 2).shape
    numbers = np.zeros((2, 2, 2, *shape))
    for (position, misalignment, distance), entry in grid.nodal.items():
        numbers[misalignment, distance, position] = np.moveaxis(entry, 0, 2)
    return numbers
