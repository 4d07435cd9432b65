"""Forces and moments on the bearings of a run."""

from __future__ import annotations

import numpy as np

from dynamics.errors import InputError
from dynamics.results import RunResult
from dynamics.types import FloatArray


def bearing_signals(result: RunResult) -> FloatArray:
    """Return forces on bearings over time, (b, 3, T) in N, with moments (b, 6, T) in N m where there are any.

    Raises
    ------
    InputError
        The run holds no bearing forces.
    """
    if not len(result.bearing_force):
        advice = "Run the scene with bearing forces among its outputs."
        raise InputError("bearing_force", "none", "a run with bearing forces", advice)
    if not result.bearing_moment.size:
        return result.bearing_force
    return np.concatenate([result.bearing_force, result.bearing_moment], axis=1)
