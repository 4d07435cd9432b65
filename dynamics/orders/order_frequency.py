"""The frequency by which orders of a run count: of a mesh, or without one of a shaft's rotation."""

from __future__ import annotations

import math

import numpy as np

from dynamics.results import RunResult
from dynamics.types import FloatArray


def order_frequency(result: RunResult, mesh: int = 0) -> FloatArray:
    """Return the mesh frequency, without meshes the rotations per second of the leading shaft, (T,)."""
    if result.mesh:
        return np.asarray(result.mesh_frequency[mesh])
    speed = result.speed[result.shaft.index(leading_shaft(result))]
    return np.asarray(np.abs(speed) / (2.0 * math.pi))


def leading_shaft(result: RunResult) -> str:
    """Return the shaft of the first drive or free rotation."""
    return str([*result.case["drives"], *result.case["free_rotations"]][0]["shaft"])
