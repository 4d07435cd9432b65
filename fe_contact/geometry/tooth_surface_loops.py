"""Flanks of single teeth at many points, compiled."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fe_contact.flank.bicubic import cell_value, cell_weights
from fe_contact.types import FloatArray, IntArray
from host.loops import inner, njit

if TYPE_CHECKING:
    from fe_contact.geometry.tooth_surfaces import PackedGrids


@njit(cache=True, error_model="numpy")
def surfaces_excess(
    tooth: IntArray,
    roll_length: FloatArray,
    face: FloatArray,
    ends: tuple[float, float],
    face_width: float,
    amounts: FloatArray,
    grids: PackedGrids,
) -> FloatArray:
    """Return how far flanks of teeth stand towards the mate, m, at points (k,); see `ToothSurfaces`.

    Off the usable profile the values at its ends apply.
    """
    excess = np.zeros(tooth.size)
    across, along = np.zeros(4), np.zeros(4)
    middle, half = 0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0])
    i, j, before = 0, 0, -1  # cells and tooth of the point before: many points in turn are of one profile
    for k in range(tooth.size):
        if tooth[k] >= len(amounts):
            before = -1
            continue
        slope, form, waves, helix, helix_form, helix_waves = amounts[tooth[k]]
        u = min(max((roll_length[k] - middle) / half, -1.0), 1.0)
        v = 2.0 * face[k] / face_width
        excess[k] = 0.5 * (slope * u + helix * v) + _form(form, waves, u) + _form(helix_form, helix_waves, v)
        grid = grids.of_tooth[tooth[k]]
        if grid >= 0:
            rows, columns = grids.sizes[grid, 0], grids.sizes[grid, 1]
            row, column, node = grids.starts[grid]
            i = cell_weights(grids.roll, (row, rows), middle + half * u, i, across)
            if tooth[k] != before or face[k] != face[k - 1]:
                j = cell_weights(grids.face, (column, columns), face[k], j, along)
            before = tooth[k]
            excess[k] -= cell_value(grids.nodes, node + i * columns + j, columns, across, along)
        else:
            before = -1
    return excess


@inner(error_model="numpy")
def _form(height: float, waves: float, at: float) -> float:
    """Return a form deviation of this height over -1 to 1; its mean line is zero, as in a measurement.

    It is a parabola where `waves` is 0, else a cosine of so many waves.
    """
    if height == 0.0:
        return 0.0
    if waves == 0.0:
        return height * (1.0 / 3.0 - at * at)
    return height * 0.5 * math.cos(math.pi * waves * at)
