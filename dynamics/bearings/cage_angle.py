"""The angle of a bearing's cage among the positions of a local state."""

from __future__ import annotations

import math

from dynamics.kernels.compiled import inner
from dynamics.kernels.local_state import LocalState


@inner
def cage_angle(local: LocalState, turned: int) -> float:
    """Return the angle of the position `turned`, which is in revolutions, rad; 0 if it is -1: averaged."""
    return 2.0 * math.pi * float(local.position[turned]) if turned >= 0 else 0.0
