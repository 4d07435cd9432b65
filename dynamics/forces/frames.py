"""Forces of rotating frames: gyroscopic moments, Coriolis and centripetal terms, couplings across frames."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from dynamics.kernels.compiled import inner
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import BoolArray, FloatArray, IntArray

# Gyroscopic moments, Coriolis and centripetal terms, centrifugal loads.


@dataclass(frozen=True)
class FrameTerm:
    """A term of a rotating-frame element."""

    rows: FloatArray
    """Its coordinates across the axis, m, in all rotors' freedoms. Shape (2, N)."""
    factors: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    """Those of `RotatingFrameLaws`."""
    load: tuple[float, float] = (0.0, 0.0)
    """Its load, kg m."""

    def plus(self, other: FrameTerm) -> FrameTerm:
        """Return the sum of two terms whose rows move alike."""
        a, b, c, d, e = (x + y for x, y in zip(self.factors, other.factors, strict=True))
        load = (self.load[0] + other.load[0], self.load[1] + other.load[1])
        return replace(self, factors=(a, b, c, d, e), load=load)


class RotatingFrameLaws(NamedTuple):
    """l elements in y = (a, b) across the axis of a shaft of spin w in a frame of speed W.

    With J = z x the inertia resists by (c_1 w + c_2 W) J y' + (c_3 w W + c_4 W^2) y, a ground damper seen
    from the frame by c_5 W J y, and a body off the frame's axis is pulled outwards by l W^2.
    """

    factor: FloatArray
    """c_1 to c_5: kg, kg/rad ..., N s/m. Shape (l, 5)."""
    load: FloatArray
    """l: mass times arm from the frame's axis, kg m. Shape (l, 2)."""
    lever: FloatArray
    """Of the row of the spin, m: row over angle. Shape (l,)."""
    spinning: BoolArray
    """Whether a third row adds the shaft's own rotation to the spin of the kinematic motion. Shape (l,)."""

    @classmethod
    def packed(cls, terms: Sequence[FrameTerm], lever: float, spinning: Sequence[bool]) -> RotatingFrameLaws:
        """Lay out `terms`; `spinning` says whose shaft adds its own rotation to the spin."""
        return cls(
            np.array([term.factors for term in terms], dtype=float).reshape(-1, 5),
            np.array([term.load for term in terms], dtype=float).reshape(-1, 2),
            np.full(len(terms), lever),
            np.array(spinning, dtype=np.bool_),
        )


@routine
def rotating_frame(laws: RotatingFrameLaws, entry: int, local: LocalState, row: int, e: int) -> None:
    """Write forces and derivatives into the rows of element `e`, the first of which is `row`.

    The row of the spin carries no force: what stays 0 is 0 from the start.
    """
    coordinate, rate, force, elastic = local.coordinate, local.rate, local.force, local.elastic
    tangent, viscous = local.tangent, local.viscous
    spin, frame = local.speed[e, 0], local.speed[e, 1]
    rows = 2
    if laws.spinning[entry]:
        rows = 3
        spin += rate[row + 2] / laws.lever[entry]
    c = laws.factor
    swirl = c[entry, 0] * spin + c[entry, 1] * frame
    hold = c[entry, 2] * spin * frame + c[entry, 3] * frame * frame
    drag = c[entry, 4] * frame
    for k in range(2):
        other, sign = 1 - k, 2.0 * k - 1.0  # J y = (-y_2, y_1)
        here, there = coordinate[row + k], coordinate[row + other]
        elastic[row + k] = hold * here - laws.load[entry, k] * frame * frame
        force[row + k] = sign * (swirl * rate[row + other] + drag * there) + elastic[row + k]
        tangent[row + k, k], tangent[row + k, other] = hold, sign * drag
        viscous[row + k, other] = sign * swirl
        if rows == 2:
            continue
        by_spin = sign * c[entry, 0] * rate[row + other] + c[entry, 2] * frame * here
        viscous[row + k, 2] = by_spin / laws.lever[entry]


@routine
def rotating_frame_energy(laws: RotatingFrameLaws, entry: int, local: LocalState, row: int, e: int) -> float:
    """Return the energy of the terms in y and of the load, J; negative where they push outwards."""
    spin, frame, y = local.speed[e, 0], local.speed[e, 1], local.coordinate
    hold = laws.factor[entry, 2] * spin * frame + laws.factor[entry, 3] * frame**2
    pulled = frame**2 * (laws.load[entry, 0] * y[row] + laws.load[entry, 1] * y[row + 1])
    return float(0.5 * hold * (y[row] ** 2 + y[row + 1] ** 2) - pulled)


# A coupling between shafts described in frames that turn against each other.


class FrameCouplingLaws(NamedTuple):
    """l couplings in y = (a, b): n lengths of one shaft, then n of the other, each in its own frame.

    n is 2 (across the axis) or 4 (tilts about x and y times a lever too). The second frame has turned by psi
    against the first. With R = R(psi) for each pair of directions,

        d = a - R b,    F = K d + C d',    d' = a' - R b' - psi' J R b,    J = z x,

    and F pushes the first shaft back and, turned by R^T, the second along. K and C are the same in all
    directions across the axis: they commute with R.
    """

    size: IntArray
    """n. Shape (l,)."""
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: N/m, N s/m. Shape (l, 4, 4) each."""


@inner
def _turned(row: int, i: int, c: float, s: float, values: FloatArray) -> float:
    if i % 2 == 0:
        return float(c * values[row + i] - s * values[row + i + 1])
    return float(s * values[row + i - 1] + c * values[row + i])


@inner
def _strain(row: int, n: int, i: int, c: float, s: float, coordinate: FloatArray) -> float:
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
            # d d'/d b = -psi' J R adds C psi' J to the stiffness that b sees
            seen = k[entry, i, j] + turn * sign * damping[entry, i, other]
            beside = k[entry, i, other] - turn * sign * damping[entry, i, j]
            tangent[row + i, j] = k[entry, i, j]
            tangent[row + i, n + j] = -(c * seen + sign * s * beside)
            tangent[row + n + i, n + j] = seen
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
