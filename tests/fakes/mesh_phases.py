"""The position of a mesh in the kinematic motion, as the compiled loops compute it."""

import numpy as np

from dynamics.arrays.arrays import KinematicMotion
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled
from dynamics.kernels.local_state import LocalState
from dynamics.motion.motion import set_phases


@compiled
def _set(reference: KinematicMotion, motion: np.ndarray, position: np.ndarray, local: LocalState) -> None:
    set_phases(reference, motion, position, local)


def flank_phase(reference: KinematicMotion, mesh: int, motion: np.ndarray) -> float:
    """Return a mesh's position, base pitches in [0, period), at the `motion` (k, 4) of the laws."""
    position = np.zeros(reference.offset.size)
    local = LocalState.empty(0, 1, position.size, laws=motion.shape[0])
    _set(by_address(reference), motion, position, by_address(local))
    return float(position[mesh])
