"""Planets on their carrier: rigid in the kinematic motion and where nothing lets them move."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, rigid_motion
from dynamics.mechanism.rotor import Rotor
from dynamics.types import FloatArray, IntArray

PLANET_KINDS = 5  # x, y, z, tilt_x, tilt_y: the carrier takes a planet along in these, not in its rotation


FREEDOMS = ("x", "y", "z", "tilt_x", "tilt_y", "rotation")


ROTATION = FREEDOMS.index("rotation")


def carried_motion(rotors: Bodies, free: IntArray) -> FloatArray:
    """Return the motion (N, N) of all freedoms where only the freedoms `free` are independent.

    A freedom of a planet that is not free follows the carrier; other freedoms follow none.
    """
    motion = np.eye(column_count(rotors))
    for index, rotor in enumerate(rotors):
        if rotor.carrier is None:
            continue
        arm = rotor.center - rotors[rotor.carrier].center
        with_carrier = rigid_motion(arm)[:5]
        for kind in range(PLANET_KINDS):
            if 6 * index + kind not in free:
                motion[6 * index + kind, 6 * rotor.carrier : 6 * rotor.carrier + 6] = with_carrier[kind]
    return motion


def rotational_inertia(rotors: Sequence[Rotor]) -> FloatArray:
    """Return (r,): polar inertia of each rotor; on a carrier also its planets' masses about its axis."""
    inertia = np.array([rotor.inertia.polar for rotor in rotors], dtype=float)
    for rotor in rotors:
        if rotor.carrier is not None:
            arm = rotor.center - rotors[rotor.carrier].center
            inertia[rotor.carrier] += rotor.inertia.mass * float(arm[0] ** 2 + arm[1] ** 2)
    return inertia
