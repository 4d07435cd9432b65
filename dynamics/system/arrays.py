"""The assembled system as plain arrays: what the compiled loops see."""

from __future__ import annotations

from typing import NamedTuple

from dynamics.forces.flank_force import FlankLaws
from dynamics.types import FloatArray, IntArray


class LawArrays(NamedTuple):
    """Piecewise cubic laws of time, one after the other in flat arrays.

    Attributes
    ----------
    first : (l + 1,) int array
        First piece of each law.
    start : (S,) array
        Start times of the pieces, s.
    coefficient : (S, 4) array
        Ascending coefficients in the time since the piece's start.
    """

    first: IntArray
    start: FloatArray
    coefficient: FloatArray


class Reference(NamedTuple):
    """The kinematic motion: every shaft turns by its exact ratio to the drive.

    Attributes
    ----------
    speed : LawArrays
        One law: speed of the drive, rad/s.
    whole, fraction : (S,) arrays
        Revolutions of the drive at the start of each piece, integer and remainder.
    numerator, denominator : (m,) int arrays
        Base pitches per revolution of the drive for each flank, an exact fraction.
    offset : (m,) array
        Position of each flank at t = 0, base pitches.
    period : (m,) int array
        Base pitches after which the flank's table repeats.
    """

    speed: LawArrays
    whole: FloatArray
    fraction: FloatArray
    numerator: IntArray
    denominator: IntArray
    offset: FloatArray
    period: IntArray


class Loads(NamedTuple):
    """Load torques.

    Attributes
    ----------
    torque : LawArrays
        One law per load, N m.
    direction : (l, n) array
        Generalised force per unit torque.
    reference : (l,) array
        Work per unit torque and per unit angle of the drive in the kinematic motion.
    drive : (l,) array
        Torque on the drive's own shaft per unit torque.
    """

    torque: LawArrays
    direction: FloatArray
    reference: FloatArray
    drive: FloatArray


class SystemArrays(NamedTuple):
    """n freedoms q (deviations from the kinematic motion), m flanks.

    M q'' + C q' + K q + sum_f g_f F_f(x_f, g_f q, g_f q') = external(t).

    Attributes
    ----------
    mass, damping, stiffness : (n, n) arrays
        M, C, K; symmetric.
    block : (n, 2) int array
        First and end column of each row's diagonal block, shared by M, C and K: only flanks couple blocks.
    direction : (m, n) array
        g_f: derivative of the transmission error in q.
    turn : (m, n) array
        Derivative of the flank's position in q, base pitches.
    drive_direction : (m,) array
        Derivative of the transmission error in the rotation of the drive's shaft alone.
    inertial : (n,) array
        External force per angular acceleration of the drive: minus inertia times ratio.
    drive_inertia, total_inertia : float
        Polar inertia of the drive's shaft; of all shafts as seen at the drive, kg m^2.
    scale : (n,) array
        Metres per unit of q, for error norms: 1, or a base radius for rotations.
    rate_scale : (n,) array
        Metres per unit of q': `scale` over the natural frequency of the freedom alone, held by its bushings
        and meshes. An error of the rate becomes an error of the displacement of this size a quarter period
        later.
    """

    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    block: IntArray
    direction: FloatArray
    turn: FloatArray
    drive_direction: FloatArray
    inertial: FloatArray
    drive_inertia: float
    total_inertia: float
    scale: FloatArray
    rate_scale: FloatArray
    flank: FlankLaws
    reference: Reference
    load: Loads
