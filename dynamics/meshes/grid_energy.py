"""Compiled potential energy of a table over all axes, with its derivatives."""

from __future__ import annotations

from dynamics.kernels.compiled import inner
from dynamics.meshes.grid_lookup import DEFLECTION, STIFFNESS, Cell, Sample, Weights, sample
from dynamics.meshes.grid_tables import GridTables


@inner
def grid_energy(grid: GridTables, flank: int, cell: Cell, deflection: float) -> Sample:
    """Return V = integral of the force over the deflection from lift-off, J.

    Its derivatives are those at constant deflection. With levels F_k at deflections d_k and stiffness K_k, a
    whole interval of width h holds h (F_k + F_k+1)/2 + h^2 (K_k - K_k+1)/12.
    """
    # the table's first level among those of all tables, and the last interval between its levels
    level, last = grid.base.offset[flank, 4], grid.base.offset[flank, 5] - 2
    value, in_x, in_m, in_a = 0.0, 0.0, 0.0, 0.0
    low = sample(grid.number, cell, 0, DEFLECTION)
    stiff = sample(grid.number, cell, 0, STIFFNESS)
    k = 0
    while k <= last and deflection > low.value:
        high = sample(grid.number, cell, k + 1, DEFLECTION)
        end = sample(grid.number, cell, k + 1, STIFFNESS)
        start, top = grid.base.level[level + k], grid.base.level[level + k + 1]
        w = min((deflection - low.value) / (high.value - low.value), 1.0)
        ends = (low.value, high.value, stiff.value, end.value)
        value += _area(w, start, top, ends)
        in_x += _area_slope(w, start, top, ends, (low.x, high.x, stiff.x, end.x))
        in_m += _area_slope(w, start, top, ends, (low.m, high.m, stiff.m, end.m))
        in_a += _area_slope(w, start, top, ends, (low.a, high.a, stiff.a, end.a))
        low, stiff = high, end
        k += 1
    beyond = deflection - low.value
    if k == last + 1 and beyond > 0.0:
        force, half = grid.base.level[level + k] + stiff.value * beyond, 0.5 * beyond * beyond
        value += beyond * (grid.base.level[level + k] + 0.5 * stiff.value * beyond)
        in_x += half * stiff.x - force * low.x
        in_m += half * stiff.m - force * low.m
        in_a += half * stiff.a - force * low.a
    return Sample(value, in_x, in_m, in_a)


@inner
def _area(w: float, start: float, top: float, ends: Weights) -> float:
    """Return the energy of a level interval up to the fraction `w`; `ends`: deflections, then stiffnesses.

    The force on the interval is start + rise w + c2 w^2 + c3 w^3.
    """
    span = ends[1] - ends[0]
    rise, fall, step = span * ends[2], span * ends[3], top - start
    c2, c3 = 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step
    return float(span * w * (start + w * (rise / 2.0 + w * (c2 / 3.0 + w * c3 / 4.0))))


@inner
def _area_slope(w: float, start: float, top: float, ends: Weights, slopes: Weights) -> float:
    """Return the derivative of `_area` as the ends move by `slopes`.

    The deflection stays constant; in an interval below it, where w = 1, w does.
    """
    span, span_slope = ends[1] - ends[0], slopes[1] - slopes[0]
    rise, fall, step = span * ends[2], span * ends[3], top - start
    c2, c3 = 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step
    rise_slope = span_slope * ends[2] + span * slopes[2]
    fall_slope = span_slope * ends[3] + span * slopes[3]
    area = w * (start + w * (rise / 2.0 + w * (c2 / 3.0 + w * c3 / 4.0)))
    change = rise_slope / 2.0 + w * (
        -(2.0 * rise_slope + fall_slope) / 3.0 + w * (rise_slope + fall_slope) / 4.0
    )
    w_slope = 0.0 if w == 1.0 else -(slopes[0] + w * span_slope) / span
    force = start + w * (rise + w * (c2 + w * c3))
    return float(span_slope * area + span * (force * w_slope + w * w * change))
