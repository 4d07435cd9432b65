"""A coupling between shafts described in frames that turn against each other."""

from __future__ import annotations

import math
from typing import NamedTuple

from dynamics.kernels.compiled import inner
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import FloatArray, IntArray


class FrameCouplingLaws(NamedTuple):
    """l couplings in y = (a, b): n lengths of one shaft, then n of the other, each in its own frame.

    n is 2 (across the axis) or 4 (tilts about x and y times a lever too). The second frame has turned by psi
    against the first. With R = R(psi) for each pair of directions,

        d = a - R b,    F = K d + C d',    d' = a' - R b' - psi' J R b,    J = z x,

    where J maps x to y and y to -x: in it the other direction of component i is i + 1 or i - 1. F pushes the
    first shaft back and, turned by R^T, the second along. K and C are the same in all directions across the
    axis: they commute with R.
    """

    size: IntArray
    """n. Shape (l,)."""
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: Stiffness, N/m, and damping, N s/m. Shape (l, 4, 4) each."""


@inner
def _turned(row: int, i: int, c: float, s: float, values: FloatArray) -> float:
    """Return component `i` of R times the values from `row` on; R^T with -s."""
    if i % 2 == 0:
        return float(c * values[row + i] - s * values[row + i + 1])
    return float(s * values[row + i - 1] + c * values[row + i])


@inner
def _strain(row: int, n: int, i: int, c: float, s: float, coordinate: FloatArray) -> float:
    """Return component `i` of d."""
    return float(coordinate[row + i]) - _turned(row + n, i, c, s, coordinate)


@inner
def _strain_rate(
    row: int, n: int, i: int, c: float, s: float, turn: float, coordinate: FloatArray, rate: FloatArray
) -> float:
    """Return component `i` of d'."""
    other = i + 1 if i % 2 == 0 else i - 1
    sign = -1.0 if i % 2 == 0 else 1.0
    swept = turn * sign * _turned(row + n, other, c, s, coordinate)
    return float(rate[row + i]) - _turned(row + n, i, c, s, rate) - swept


@routine
def frame_coupling(laws: FrameCouplingLaws, entry: int, local: LocalState, row: int, turned: int) -> None:
    """Write forces and derivatives into the 2 n rows of a coupling, the first of which is `row`.

    The position `turned` is psi, in revolutions.
    """
    coordinate, rate, force, elastic = local.coordinate, local.rate, local.force, local.elastic
    tangent, viscous = local.tangent, local.viscous
    n, k, damping = laws.size[entry], laws.stiffness, laws.damping
    angle, turn = 2.0 * math.pi * local.position[turned], 2.0 * math.pi * local.pace[turned]
    c, s = math.cos(angle), math.sin(angle)
    for i in range(n):
        spring, total = 0.0, 0.0
        for j in range(n):
            pull = k[entry, i, j] * _strain(row, n, j, c, s, coordinate)
            spring += pull
            total += pull + damping[entry, i, j] * _strain_rate(row, n, j, c, s, turn, coordinate, rate)
        elastic[row + i], force[row + i] = spring, total
    for i in range(n):  # turned back into the second frame
        elastic[row + n + i] = -_turned(row, i, c, -s, elastic)
        force[row + n + i] = -_turned(row, i, c, -s, force)
    for i in range(n):
        for j in range(n):
            other = j + 1 if j % 2 == 0 else j - 1
            sign = 1.0 if j % 2 == 0 else -1.0
            # d d'/d b = -psi' J R adds C psi' J to the stiffness against b
            effective = k[entry, i, j] + turn * sign * damping[entry, i, other]
            cross = k[entry, i, other] - turn * sign * damping[entry, i, j]
            tangent[row + i, j] = k[entry, i, j]
            tangent[row + i, n + j] = -(c * effective + sign * s * cross)
            tangent[row + n + i, n + j] = effective
            # R^T K = K R^T
            tangent[row + n + i, j] = -(c * k[entry, i, j] - sign * s * k[entry, i, other])
            viscous[row + i, j] = damping[entry, i, j]
            viscous[row + i, n + j] = -(c * damping[entry, i, j] + sign * s * damping[entry, i, other])
            viscous[row + n + i, n + j] = damping[entry, i, j]
            viscous[row + n + i, j] = -(c * damping[entry, i, j] - sign * s * damping[entry, i, other])


@routine
def frame_coupling_energy(
    laws: FrameCouplingLaws, entry: int, local: LocalState, row: int, turned: int
) -> tuple[float, float]:
    """Return the energy stored, J, and its derivative in psi, J per revolution."""
    n, coordinate, angle = laws.size[entry], local.coordinate, 2.0 * math.pi * local.position[turned]
    c, s = math.cos(angle), math.sin(angle)
    energy, slope = 0.0, 0.0
    for i in range(n):
        spring = 0.0
        for j in range(n):
            spring += laws.stiffness[entry, i, j] * _strain(row, n, j, c, s, coordinate)
        other = i + 1 if i % 2 == 0 else i - 1
        sign = -1.0 if i % 2 == 0 else 1.0
        energy += 0.5 * spring * _strain(row, n, i, c, s, coordinate)
        slope -= 2.0 * math.pi * spring * sign * _turned(row + n, other, c, s, coordinate)
    return energy, slope
