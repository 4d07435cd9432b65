"""Rollers between two raceways, in laminae: force, tangent and energy from five displacements, compiled.

The raceways approach each other along the normal of the contact, evenly and by their tilt in the roller's
axial plane. Each lamina carries c press^(10/9) on its own.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from dynamics.forces.bearing_seat import DIRECTIONS, BearingSeat
from dynamics.forces.compiled import compiled, inner
from dynamics.types import FloatArray, IntArray

EXPONENT = 10.0 / 9.0


class RollerElements(NamedTuple):
    """Rollers of l bearings.

    Attributes
    ----------
    rollers : (l,) int array
        Their number.
    stiffness : (l,) array
        c of one lamina between both raceways, N/m^(10/9).
    cosine, sine : (l,) arrays
        Of the contact angle; the normal has these parts along radius and axis.
    radius : (l,) array
        Of the circle of the rollers' centers, m.
    play : (l,) array
        Approach along the normal at which the middle of a roller just touches, m; negative: preload.
    first : (l + 1,) int array
        First lamina of each bearing.
    place, drop : (L,) arrays
        Middle of each lamina along the roller and by how much its profile is lower there, on both contacts
        together, m.
    """

    rollers: IntArray
    stiffness: FloatArray
    cosine: FloatArray
    sine: FloatArray
    radius: FloatArray
    play: FloatArray
    first: IntArray
    place: FloatArray
    drop: FloatArray


@compiled
def roller_elements(laws: RollerElements, entry: int, angle: float, seat: BearingSeat) -> tuple[float, float]:
    """Write force, tangent and loads of a bearing; return its energy (J) and the derivative in `angle`.

    The first roller stands at `angle` (rad) from x towards y, the others evenly behind it. A lamina at p
    along the roller is pressed by u + p turn - drop, with rows g of u and t of turn in the displacements:

        force = g sum q + t sum q p,    tangent = g g^T sum k + (g t^T + t g^T) sum k p + t t^T sum k p^2.
    """
    x, y, z = seat.displacement[0], seat.displacement[1], seat.displacement[2]
    tilt_x, tilt_y = seat.displacement[3], seat.displacement[4]
    cosine, sine = laws.cosine[entry], laws.sine[entry]
    lever = laws.radius[entry] * sine
    step = 2.0 * math.pi / laws.rollers[entry]
    seat.force[:] = 0.0
    seat.tangent[:] = 0.0
    seat.load[:] = 0.0
    energy, slope = 0.0, 0.0
    for roller in range(laws.rollers[entry]):
        c, s = math.cos(angle + roller * step), math.sin(angle + roller * step)
        turn = tilt_y * c - tilt_x * s
        middle = (x * c + y * s) * cosine + z * sine - lever * turn - laws.play[entry]
        load, moment, k, kp, kpp, stored = _laminae(laws, entry, roller, middle, turn, seat)
        if load == 0.0:
            continue
        g = (c * cosine, s * cosine, sine, s * lever, -c * lever)
        t = (0.0, 0.0, 0.0, -s, c)
        for i in range(DIRECTIONS):
            seat.force[i] += load * g[i] + moment * t[i]
            for j in range(DIRECTIONS):
                mixed = kp * (g[i] * t[j] + t[i] * g[j])
                seat.tangent[i, j] += k * g[i] * g[j] + mixed + kpp * t[i] * t[j]
        turned = -(tilt_y * s + tilt_x * c)
        energy += stored
        slope += load * ((y * c - x * s) * cosine - lever * turned) + moment * turned
    return energy, slope


@inner
def _laminae(
    laws: RollerElements, entry: int, roller: int, middle: float, turn: float, seat: BearingSeat
) -> tuple[float, float, float, float, float, float]:
    """Return load, moment about the middle, the three stiffnesses and the energy of a roller."""
    load, moment, k, kp, kpp, stored = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for lamina in range(laws.first[entry], laws.first[entry + 1]):
        place = laws.place[lamina]
        press = middle + place * turn - laws.drop[lamina]
        if press <= 0.0:
            continue
        rigid = laws.stiffness[entry] * press ** (EXPONENT - 1.0)
        q = rigid * press
        seat.load[roller, lamina - laws.first[entry]] = q
        load += q
        moment += q * place
        k += EXPONENT * rigid
        kp += EXPONENT * rigid * place
        kpp += EXPONENT * rigid * place * place
        stored += q * press / (EXPONENT + 1.0)
    return load, moment, k, kp, kpp, stored
