"""Rollers between two raceways, in laminae: forces, derivatives, energy from five displacements, compiled.

The raceways approach each other along the normal of the contact, evenly and by their tilt in the roller's
axial plane. Each lamina carries q = c press^(10/9) on its own, and is damped in proportion to it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.bearings import RollerBearing
from dynamics.bearings.ball_elements import RowPlacement, cage_angle
from dynamics.kernels.compiled import compiled, inner
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import FloatArray, IntArray

EXPONENT = 10.0 / 9.0  # exponent of line contact, from load over approach
DIRECTIONS = 5  # number of displacements of a bearing: x, y, z, tilt_x, tilt_y


class RollerElements(NamedTuple):
    """Rollers of l bearings."""

    rollers: IntArray
    """Number of rollers of each bearing. Shape (l,)."""
    stiffness: FloatArray
    """c of one lamina between both raceways, N/m^(10/9). Shape (l,)."""
    damping: FloatArray
    """Damping of a lamina over its load, s/m. Shape (l,)."""
    cosine: FloatArray
    sine: FloatArray
    """`cosine`, `sine`: Cosine and sine of the contact angle, the parts of the normal along radius and axis.
    Shape (l,) each.
    """
    arm: FloatArray
    """Radius of the circle of the rollers' centers times the sine, over the lever of tilts. Shape (l,)."""
    play: FloatArray
    """Approach along the normal at which the middle of a roller just touches, m; negative: preload. Shape
    (l,).
    """
    first: IntArray
    """First lamina of each bearing. Shape (l + 1,)."""
    coordinate: FloatArray
    drop: FloatArray
    """`coordinate`, `drop`: Middle of each lamina along the roller over the lever of tilts, and relief of the
    profile at it, on both contacts together, m. Shape (L,) each.
    """

    @classmethod
    def packed(cls, rows: Sequence[tuple[RollerBearing, RowPlacement]]) -> RollerElements:
        """Lay out `rows` with their placements."""
        figures = [_figures(bearing, at) for bearing, at in rows]
        coordinates = [bearing.lamina_places for bearing, _ in rows]
        drops = [
            2.0 * bearing.drop(coordinate) for (bearing, _), coordinate in zip(rows, coordinates, strict=True)
        ]
        places_over_lever = [
            coordinate / at.lever for (_, at), coordinate in zip(rows, coordinates, strict=True)
        ]
        return cls(
            rollers=np.array([bearing.count * at.copies for bearing, at in rows], dtype=np.int64),
            first=np.cumsum([0, *(bearing.laminae for bearing, _ in rows)], dtype=np.int64),
            coordinate=np.concatenate([np.empty(0), *places_over_lever]),
            drop=np.concatenate([np.empty(0), *drops]),
            **{
                name: np.array([figure[name] for figure in figures], dtype=float)
                for name in ("stiffness", "damping", "cosine", "sine", "arm", "play")
            },
        )


def _figures(bearing: RollerBearing, at: RowPlacement) -> dict[str, float]:
    """Return the figures of a row by the fields of `RollerElements`."""
    cosine, sine = math.cos(bearing.contact_angle), math.sin(bearing.contact_angle)
    return {
        "stiffness": bearing.lamina_stiffness / at.copies,
        "damping": at.damping,
        "cosine": cosine,
        "sine": sine,
        "arm": bearing.pitch_diameter / 2.0 * sine / at.lever,
        "play": bearing.play - at.shift * sine,
    }


@inner
def _middle(
    laws: RollerElements, entry: int, c: float, s: float, y: FloatArray, row: int
) -> tuple[float, float]:
    """Return approach and tilt of the raceways at the middle of a roller whose angle has cosine c, sine s."""
    turn = y[row + 4] * c - y[row + 3] * s
    across = (y[row] * c + y[row + 1] * s) * laws.cosine[entry]
    return across + y[row + 2] * laws.sine[entry] - laws.arm[entry] * turn, turn


@routine
def rollers(laws: RollerElements, entry: int, local: LocalState, row: int, turned: int) -> None:
    """Write forces and derivatives of a bearing into its five rows, the first of which is `row`.

    A lamina at x along the roller is pressed by p = u + x psi - drop, with rows g of u and t of psi in the
    coordinates. With F = q (1 + d p') or 0 if that is tensile, k = dF/dp and d its damping,

        f = g sum F + t sum F x,    df/dy = g g^T sum k + (g t^T + t g^T) sum k x + t t^T sum k x^2,

    and df/dy' alike with q d for k. The first roller stands at the cage's angle from x towards y, position
    `turned`, the others behind it.
    """
    for i in range(DIRECTIONS):
        local.force[row + i], local.elastic[row + i] = 0.0, 0.0
        for j in range(DIRECTIONS):
            local.tangent[row + i, j], local.viscous[row + i, j] = 0.0, 0.0
    angle, step = cage_angle(local, turned), 2.0 * math.pi / laws.rollers[entry]
    cosine, sine, arm = laws.cosine[entry], laws.sine[entry], laws.arm[entry]
    for roller in range(laws.rollers[entry]):
        c, s = math.cos(angle + roller * step), math.sin(angle + roller * step)
        pressed, turn = _middle(laws, entry, c, s, local.coordinate, row)
        closing, turning = _middle(laws, entry, c, s, local.rate, row)
        sums = _laminae(laws, entry, pressed - laws.play[entry], turn, closing, turning)
        if sums[0] > 0.0:
            g = (c * cosine, s * cosine, sine, s * arm, -c * arm)
            _add(local, row, g, (0.0, 0.0, 0.0, -s, c), sums)


@inner
def _laminae(
    laws: RollerElements, entry: int, middle: float, turn: float, closing: float, turning: float
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """Return sums over the laminae of q and F with x^0 and x^1, and of k and q d with x^0, x^1, x^2."""
    load, moment, total, turns = 0.0, 0.0, 0.0, 0.0
    k, kx, kxx, d, dx, dxx = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for lamina in range(laws.first[entry], laws.first[entry + 1]):
        x = laws.coordinate[lamina]
        press = middle + x * turn - laws.drop[lamina]
        if press <= 0.0:
            continue
        rigid = laws.stiffness[entry] * press ** (EXPONENT - 1.0)
        q = rigid * press
        load += q
        moment += q * x
        factor = 1.0 + laws.damping[entry] * (closing + x * turning)
        if factor <= 0.0:
            continue
        total += q * factor
        turns += q * factor * x
        stiffness, viscous = EXPONENT * rigid * factor, q * laws.damping[entry]
        k += stiffness
        kx += stiffness * x
        kxx += stiffness * x * x
        d += viscous
        dx += viscous * x
        dxx += viscous * x * x
    return load, moment, total, turns, k, kx, kxx, d, dx, dxx


@inner
def _add(
    local: LocalState, row: int, g: tuple[float, ...], t: tuple[float, ...], sums: tuple[float, ...]
) -> None:
    """Add the forces of a roller, by the sums over its laminae."""
    load, moment, total, turns, k, kx, kxx, d, dx, dxx = sums
    for i in range(DIRECTIONS):
        local.elastic[row + i] += load * g[i] + moment * t[i]
        local.force[row + i] += total * g[i] + turns * t[i]
        for j in range(DIRECTIONS):
            gg, gt, tt = g[i] * g[j], g[i] * t[j] + t[i] * g[j], t[i] * t[j]
            local.tangent[row + i, j] += k * gg + kx * gt + kxx * tt
            local.viscous[row + i, j] += d * gg + dx * gt + dxx * tt


@routine
def rollers_energy(
    laws: RollerElements, entry: int, local: LocalState, row: int, turned: int
) -> tuple[float, float]:
    """Return the energy stored at the displacement in `row` and on, J, and its derivative, J/revolution."""
    y, angle = local.coordinate, cage_angle(local, turned)
    step = 2.0 * math.pi / laws.rollers[entry]
    energy, slope = 0.0, 0.0
    for roller in range(laws.rollers[entry]):
        c, s = math.cos(angle + roller * step), math.sin(angle + roller * step)
        pressed, turn = _middle(laws, entry, c, s, y, row)
        turning = -(y[row + 4] * s + y[row + 3] * c)
        across = (y[row + 1] * c - y[row] * s) * laws.cosine[entry] - laws.arm[entry] * turning
        for lamina in range(laws.first[entry], laws.first[entry + 1]):
            x = laws.coordinate[lamina]
            press = pressed - laws.play[entry] + x * turn - laws.drop[lamina]
            if press > 0.0:
                q = laws.stiffness[entry] * press**EXPONENT
                energy += q * press / (EXPONENT + 1.0)
                slope += q * (across + x * turning)
    return energy, 2.0 * math.pi * slope


@compiled
def roller_reaction(laws: RollerElements, local: LocalState, load: FloatArray) -> tuple[float, float]:
    """Write forces, derivatives and loads of the first bearing; return its energy and the slope of it.

    Its rows and its position are the first of `local`. `load` (Z, L): the elastic load of every lamina, N.
    """
    rollers(laws, 0, local, 0, 0)
    angle, step = cage_angle(local, 0), 2.0 * math.pi / laws.rollers[0]
    first = laws.first[0]
    for roller in range(laws.rollers[0]):
        c, s = math.cos(angle + roller * step), math.sin(angle + roller * step)
        pressed, turn = _middle(laws, 0, c, s, local.coordinate, 0)
        for lamina in range(first, laws.first[1]):
            press = pressed - laws.play[0] + laws.coordinate[lamina] * turn - laws.drop[lamina]
            load[roller, lamina - first] = laws.stiffness[0] * max(press, 0.0) ** EXPONENT
    energy, slope = rollers_energy(laws, 0, local, 0, 0)
    return energy, slope
