"""The state that force laws read and write at one instant."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.types import FloatArray, IntArray


class LocalState(NamedTuple):
    """The state that laws read and write at one instant; P = the largest p.

    Attributes
    ----------
    position : (m + f,) array
        Of the meshes, base pitches; then how far frames have turned against each other, revolutions.
    pace : (m + f,) array
        Their rates in the kinematic motion, per second.
    whole : (k,) array
        Whole revolutions of the laws when `whole_part` was written; NaN: never.
    whole_part : (m + f, k) array
        What they add to the positions.
    coordinate, rate : (R,) arrays
        y (m) and y' (m/s), those of the deviations from the kinematic motion.
    drift : (R,) array
        What the kinematic motion adds to the rates, m/s.
    acceleration : (R,) array
        y'' with that of the kinematic motion, m/s^2; kept only for unbalances.
    clock : (1,) array
        Time, s.
    speed : (E, 2) array
        Spin and speed of the frame in the kinematic motion, rad/s.
    force, elastic : (R,) arrays
        f and the part of it that stores energy, N.
    tangent, viscous : (R, P) arrays
        Row r: df_r/dy and df_r/dy' in the coordinates of its own element, N/m and N s/m.
    inertial : (R, P) array
        Row r: df_r/dy'', kg, of unbalances.
    hint : (E,) int array
        Where the last look-up ended: the next starts there.
    """

    position: FloatArray
    pace: FloatArray
    whole: FloatArray
    whole_part: FloatArray
    coordinate: FloatArray
    rate: FloatArray
    drift: FloatArray
    acceleration: FloatArray
    clock: FloatArray
    speed: FloatArray
    force: FloatArray
    elastic: FloatArray
    tangent: FloatArray
    viscous: FloatArray
    inertial: FloatArray
    hint: IntArray

    @classmethod
    def empty(cls, rows: int, most: int, positions: int = 1, elements: int = 1, laws: int = 0) -> LocalState:
        """Allocate for that many rows R, at `most` P of an element; m + f positions, E elements, k laws."""
        per_row = ("coordinate", "rate", "drift", "acceleration", "force", "elastic")
        return cls(
            position=np.zeros(positions),
            pace=np.zeros(positions),
            whole=np.full(laws, np.nan),
            whole_part=np.zeros((positions, laws)),
            clock=np.zeros(1),
            speed=np.zeros((elements, 2)),
            hint=np.zeros(elements, dtype=np.int64),
            **{name: np.zeros(rows) for name in per_row},
            **{name: np.zeros((rows, most)) for name in ("tangent", "viscous", "inertial")},
        )
