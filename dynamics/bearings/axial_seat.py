"""The axial seat of a bearing's ring: where a ring that its seat does not hold slides to, compiled.

A ring that slides along the axis has neither mass nor friction: it stands where the balls push it nowhere,
at the least energy. With E(y, z) that of the balls at the axial displacement z of the rings, the bearing's is

    E*(y) = min E(y, z)    over all z, or over those in the direction in which the seat does not hold.

E has no hollows in y and z together, nor has E* in y.
"""

from __future__ import annotations

import math

from dynamics.bearings.ball_grooves import BallElements, grooves
from dynamics.bearings.roller_bearing import AGAINST, ALONG
from dynamics.kernels.compiled import inner
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import FloatArray

# The angle of a bearing's cage among the positions of a local state.


@inner
def cage_angle(local: LocalState, turned: int) -> float:
    """Return the angle of the position `turned`, which is in revolutions, rad; 0 if it is -1: averaged."""
    return 2.0 * math.pi * float(local.position[turned]) if turned >= 0 else 0.0


HOLDS = ALONG | AGAINST
STEPS = 100
SETTLED = 1e-12  # of the sum of the loads of all balls
Seat = tuple[float, float, float, float, float, float, float, float]
Thrust = tuple[float, float, float, float, float, float, float]


@routine
def axial_seat(laws: BallElements, entry: int, local: LocalState, row: int, turned: int) -> Seat:
    """Return where a ring stands along the axis, and what presses it against its seat.

    A ring that slides stands between the places where the grooves of all balls are on one side. Between them
    the thrust of the balls grows with z, and safeguarded Newton steps find its zero.

    Returns
    -------
    tuple of float
        1.0 where the seat holds the ring, 0.0 where it slides; z of the rings against each other (m); the
        thrust on the seat (N), 0 of a ring that slides; the derivatives of the thrust in the five
        displacements at this z.
    """
    y, angle, held = local.coordinate, cage_angle(local, turned), laws.held[entry]
    if held != 0:
        thrust, kx, ky, kz, ktx, kty, _ = _thrust(laws, entry, angle, y, row, y[row + 2])
        if (thrust >= 0.0 and held & ALONG) or (thrust <= 0.0 and held & AGAINST):
            return 1.0, y[row + 2], thrust, kx, ky, kz, ktx, kty
    reach = laws.arm_radius[entry] * math.sqrt(y[row + 3] * y[row + 3] + y[row + 4] * y[row + 4])
    z = -laws.axial[entry]
    low, high = z - reach, z + reach
    thrust, kx, ky, kz, ktx, kty, load = _thrust(laws, entry, angle, y, row, z)
    for _ in range(STEPS):
        if abs(thrust) <= SETTLED * load:
            break
        if thrust > 0.0:
            high = z
        else:
            low = z
        z -= thrust / kz
        if not low < z < high:
            z = 0.5 * (low + high)
        thrust, kx, ky, kz, ktx, kty, load = _thrust(laws, entry, angle, y, row, z)
    return 0.0, z, 0.0, kx, ky, kz, ktx, kty


@inner
def _thrust(laws: BallElements, entry: int, angle: float, y: FloatArray, row: int, z: float) -> Thrust:
    """Return the axial force of all balls, its derivatives (`kx` to `kty`) and the sum of their loads."""
    thrust, kx, ky, kz, ktx, kty, total = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    radius, height = laws.arm_radius[entry], laws.arm_axial[entry]
    step = 2.0 * math.pi / laws.balls[entry]
    c, s, turn_c, turn_s = math.cos(angle), math.sin(angle), math.cos(step), math.sin(step)
    for ball in range(laws.balls[entry]):
        if ball > 0:  # turned from the one before: sines would cost more than the rest
            c, s = c * turn_c - s * turn_s, s * turn_c + c * turn_s
        v_r, v_z, length = grooves(laws, entry, c, s, y, row, z)
        press = length - laws.reach[entry]
        if press <= 0.0:
            continue
        rigid = laws.stiffness[entry] * math.sqrt(press)
        load, e_r, e_z = rigid * press, v_r / length, v_z / length
        along, across = 1.5 * rigid * e_z, load / length * e_r
        radial, tilting = along * e_r - across * e_z, along * (height * e_r - radius * e_z)
        tilting -= across * (height * e_z + radius * e_r)
        thrust += load * e_z
        total += load
        kx += radial * c
        ky += radial * s
        kz += along * e_z + across * e_r
        ktx -= tilting * s
        kty += tilting * c
    return thrust, kx, ky, kz, ktx, kty, total
