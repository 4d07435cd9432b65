"""The weight of all bodies of a scene."""

from __future__ import annotations

import numpy as np

from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, times_mass
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


def weight(scene: Scene, rotors: Bodies) -> FloatArray:
    """Return the force of gravity per freedom of all rotors, (N,) in N.

    It acts at the centers of mass: elastic coordinates share no momentum with the rigid motion, so gravity
    does no work on them. Shafts sag by what their bearings do to them.
    """
    acceleration = np.zeros(column_count(rotors))
    for axis, value in enumerate(scene.gravity):
        acceleration[axis : 6 * len(rotors) : 6] = value
    return np.asarray(times_mass(rotors, acceleration[None])[0])
