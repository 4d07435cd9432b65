"""Compiled look-up over position, misalignment, center distance and deflection, with all derivatives.

Every knot carries a value and its mixed derivatives; the interpolant is the tensor product of cubic Hermite
pieces, as fe_contact evaluates it. Beyond the ends of misalignment and center distance the last value holds.

Letters: x position in base pitches; m misalignment, a change of the center distance, d deflection, all in
meters; u and w fractions of an interval, 0 to 1. The numbers of a table are flat, see `GridTables.number`: by
m, a, x, level, channel (deflection, stiffness, levers), and last by order of differentiation in m, a (0, 1
each) and x.
"""

from __future__ import annotations

from typing import NamedTuple

from dynamics.kernels.compiled import inner
from dynamics.meshes.grid_tables import GridTables
from dynamics.meshes.packed_tables import PackedTables
from dynamics.meshes.table_lookup import position_interval
from dynamics.types import FloatArray

Weights = tuple[float, float, float, float]
DEFLECTION, STIFFNESS = 0, 1  # channels
_FIRST_ROW, _FIRST_LEVEL, _LEVELS = 3, 4, 5  # columns of `PackedTables.offset`


class Cell(NamedTuple):
    """The cell of a query: offsets of its sides in the numbers, and Hermite weights.

    Weights are those of value and slope at the left, then at the right side (`d...`: differentiated). An axis
    of one knot has one side.

    `first` is the offset of the left knot in m and a. `m_step`, `a_step`, `level_step` and `order_step` are
    those to the next knot, level and channel; `x_left` and `x_right` lead to the knots of x. `m_sides` and
    `a_sides` are 1 or 2.
    """

    first: int
    m_step: int
    a_step: int
    x_left: int
    x_right: int
    m_sides: int
    a_sides: int
    level_step: int
    order_step: int
    m: Weights
    dm: Weights
    a: Weights
    da: Weights
    x: Weights
    dx: Weights


class Sample(NamedTuple):
    """A quantity with its derivatives in x, m and a."""

    value: float
    x: float
    m: float
    a: float


class GridForce(NamedTuple):
    """Force in N at (x, d; m, a) with its derivatives in them, and the interval of levels it was read in."""

    value: float
    d: float
    x: float
    m: float
    a: float
    interval: int


@inner
def hermite(u: float, width: float) -> Weights:
    """Return the weights of value, slope (left), value, slope (right) at the fraction `u`."""
    s = 1.0 - u
    return (1.0 + 2.0 * u) * s * s, width * u * s * s, u * u * (3.0 - 2.0 * u), -width * u * u * s


@inner
def hermite_slope(u: float, width: float) -> Weights:
    """Differentiate `hermite` in the coordinate."""
    s = 1.0 - u
    rise = 6.0 * u * s / width
    return -rise, s * (1.0 - 3.0 * u), rise, u * (3.0 * u - 2.0)


@inner
def _axis_cell(axis: FloatArray, first: int, size: int, at: float) -> tuple[int, Weights, Weights]:
    """Return the interval of an open axis that holds `at`, the weights and their derivatives in it."""
    if size == 1:
        return 0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)
    left = 0
    while left < size - 2 and at >= axis[first + left + 1]:
        left += 1
    width = axis[first + left + 1] - axis[first + left]
    u = (at - axis[first + left]) / width
    if u < 0.0 or u > 1.0:
        return left, hermite(min(max(u, 0.0), 1.0), width), (0.0, 0.0, 0.0, 0.0)
    return left, hermite(u, width), hermite_slope(u, width)


@inner
def find_cell(grid: GridTables, flank: int, position: float, m: float, a: float) -> Cell:
    """Return the cell that holds the query."""
    base: PackedTables = grid.base
    row, u, per_width = position_interval(base, flank, position)
    levels, width = base.offset[flank, _LEVELS], 1.0 / per_width
    interval = (row - base.offset[flank, _FIRST_ROW]) // levels
    sizes = grid.shape[flank]
    m_sides, a_sides = min(sizes[0], 2), min(sizes[1], 2)
    order_step = 2 * m_sides * a_sides  # value and slope in x, for every mixed derivative in m and a
    level_step = order_step * grid.channels[flank]
    x_step = level_step * levels
    a_step = x_step * sizes[2]
    m_step = a_step * sizes[1]
    m_left, m_weights, m_slopes = _axis_cell(grid.axis, grid.axis_first[flank, 0], sizes[0], m)
    a_left, a_weights, a_slopes = _axis_cell(grid.axis, grid.axis_first[flank, 1], sizes[1], a)
    return Cell(  # in the order of its fields
        grid.first[flank] + m_left * m_step + a_left * a_step,
        m_step,
        a_step,
        interval * x_step,
        (interval + 1) % sizes[2] * x_step,  # the table is periodic in x
        m_sides,
        a_sides,
        level_step,
        order_step,
        m_weights,
        m_slopes,
        a_weights,
        a_slopes,
        hermite(u, width),
        hermite_slope(u, width),
    )


@inner
def sample(number: FloatArray, cell: Cell, level: int, channel: int) -> Sample:
    """Return one channel at one level; i, j: sides of the cell in m, a; p, q: orders of the derivatives."""
    value, in_x, in_m, in_a = 0.0, 0.0, 0.0, 0.0
    start = cell.first + level * cell.level_step + channel * cell.order_step
    for i in range(cell.m_sides):
        for j in range(cell.a_sides):
            corner = start + i * cell.m_step + j * cell.a_step
            for p in range(cell.m_sides):
                for q in range(cell.a_sides):
                    left = corner + cell.x_left + 2 * (p * cell.a_sides + q)
                    right = left - cell.x_left + cell.x_right
                    node_value = cell.x[0] * number[left] + cell.x[1] * number[left + 1]
                    node_value += cell.x[2] * number[right] + cell.x[3] * number[right + 1]
                    slope = cell.dx[0] * number[left] + cell.dx[1] * number[left + 1]
                    slope += cell.dx[2] * number[right] + cell.dx[3] * number[right + 1]
                    m, a = cell.m[2 * i + p], cell.a[2 * j + q]
                    value += m * a * node_value
                    in_x += m * a * slope
                    in_m += cell.dm[2 * i + p] * a * node_value
                    in_a += m * cell.da[2 * j + q] * node_value
    return Sample(value, in_x, in_m, in_a)


@inner
def _grid_interval(
    grid: GridTables, flank: int, cell: Cell, deflection: float, hint: int
) -> tuple[int, Sample, Sample]:
    """Return the level interval that holds `deflection`, the first or last outside, and both deflections."""
    last = grid.base.offset[flank, _LEVELS] - 2
    k = min(max(hint, 0), last)
    low = sample(grid.number, cell, k, DEFLECTION)
    high = sample(grid.number, cell, k + 1, DEFLECTION)
    while deflection < low.value and k > 0:
        k -= 1
        high = low
        low = sample(grid.number, cell, k, DEFLECTION)
    while deflection >= high.value and k < last:
        k += 1
        low = high
        high = sample(grid.number, cell, k + 1, DEFLECTION)
    return k, low, high


@inner
def grid_force(grid: GridTables, flank: int, cell: Cell, deflection: float, hint: int) -> GridForce:
    """Return the transverse force: zero below lift-off, linear by the last stiffness above the last level."""
    k, low, high = _grid_interval(grid, flank, cell, deflection, hint)
    if deflection < low.value:
        return GridForce(0.0, 0.0, 0.0, 0.0, 0.0, k)
    level = grid.base.offset[flank, _FIRST_LEVEL] + k
    start, end = grid.base.level[level], grid.base.level[level + 1]
    last = sample(grid.number, cell, k + 1, STIFFNESS)
    if deflection >= high.value:
        beyond = deflection - high.value
        return GridForce(
            end + last.value * beyond,
            last.value,
            last.x * beyond - last.value * high.x,
            last.m * beyond - last.value * high.m,
            last.a * beyond - last.value * high.a,
            k,
        )
    stiff = sample(grid.number, cell, k, STIFFNESS)
    span = high.value - low.value
    w = (deflection - low.value) / span
    rise, fall = span * stiff.value, span * last.value
    step = end - start
    # Hermite cubic: F = start + rise w + c2 w^2 + c3 w^3
    c2, c3 = 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step
    tangent = (rise + w * (2.0 * c2 + 3.0 * w * c3)) / span
    ends = (low.value, high.value, stiff.value, last.value)
    return GridForce(
        start + w * (rise + w * (c2 + w * c3)),
        tangent,
        _along(w, span, tangent, ends, (low.x, high.x, stiff.x, last.x)),
        _along(w, span, tangent, ends, (low.m, high.m, stiff.m, last.m)),
        _along(w, span, tangent, ends, (low.a, high.a, stiff.a, last.a)),
        k,
    )


@inner
def _along(w: float, span: float, tangent: float, ends: Weights, slopes: Weights) -> float:
    """Return the derivative of a level interval's cubic at constant deflection as the ends move by `slopes`.

    `ends` and `slopes`: deflection at both ends, stiffness at both ends. The derivative of the cubic F(w) has
    two parts: that of `rise` and `fall` at constant w (the step between the levels is constant), and
    dF/dw dw/dx with span dw/dx = -(slope of the lower end + w slope of the span).
    """
    span_slope = slopes[1] - slopes[0]
    rise = span_slope * ends[2] + span * slopes[2]
    fall = span_slope * ends[3] + span * slopes[3]
    bend = w * (rise + w * (-2.0 * rise - fall + w * (rise + fall)))
    return bend - tangent * (slopes[0] + w * span_slope)
