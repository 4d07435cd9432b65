"""The state that force laws read and write at one instant.

Axes of arrays: m meshes, f frames or cages that laws read, k laws of the kinematic motion, E elements, R
local coordinates of all elements, P of the element with the most.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.types import FloatArray, IntArray


class LocalState(NamedTuple):
    """The state that laws read and write at one instant; P = the largest p."""

    position: FloatArray
    """Position of the meshes, base pitches; then angles of frames against each other, revolutions. Shape
    (m + f,).
    """
    pace: FloatArray
    """Rates of the positions in the kinematic motion, per second. Shape (m + f,)."""
    full_turns: FloatArray
    """Whole revolutions of the laws when `turns_phase` was written; NaN: never. Shape (k,)."""
    turns_phase: FloatArray
    """Part of each position by the whole revolutions of each law. Shape (m + f, k)."""
    coordinate: FloatArray
    rate: FloatArray
    """`coordinate`, `rate`: y (m) and y' (m/s), those of the deviations from the kinematic motion. Shape (R,)
    each.
    """
    drift: FloatArray
    """Part of the rates by the kinematic motion, m/s. Shape (R,)."""
    acceleration: FloatArray
    """y'' with that of the kinematic motion, m/s^2; kept only for unbalances. Shape (R,)."""
    clock: FloatArray
    """Time, s. Shape (1,)."""
    speed: FloatArray
    """Spin and speed of the frame in the kinematic motion, rad/s. Shape (E, 2)."""
    force: FloatArray
    elastic: FloatArray
    """`force`, `elastic`: f and the part of it that stores energy, N. Shape (R,) each."""
    tangent: FloatArray
    viscous: FloatArray
    """`tangent`, `viscous`: Row r: df_r/dy and df_r/dy' in the coordinates of its own element, N/m and N s/m.
    Shape (R, P) each.
    """
    inertial: FloatArray
    """Row r: df_r/dy'', kg, of unbalances. Shape (R, P)."""
    hint: IntArray
    """Table interval at which the last look-up ended and the next one starts. Shape (E,)."""

    @classmethod
    def empty(
        cls, rows: int, maximum: int, positions: int = 1, elements: int = 1, laws: int = 0
    ) -> LocalState:
        """Allocate for R rows, P of an element at `maximum`; m + f positions, E elements, k laws."""
        per_row = ("coordinate", "rate", "drift", "acceleration", "force", "elastic")
        return cls(
            position=np.zeros(positions),
            pace=np.zeros(positions),
            full_turns=np.full(laws, np.nan),
            turns_phase=np.zeros((positions, laws)),
            clock=np.zeros(1),
            speed=np.zeros((elements, 2)),
            hint=np.zeros(elements, dtype=np.int64),
            **{name: np.zeros(rows) for name in per_row},
            **{name: np.zeros((rows, maximum)) for name in ("tangent", "viscous", "inertial")},
        )
