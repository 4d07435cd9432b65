"""Step control of runs under light loads: small displacements need a small tolerance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.types import FloatArray

USUAL_DEFLECTION = 1e-6
"""Transmission error, m, below which the tolerance falls in proportion.

A tolerance of 1 nm is then a thousandth of what moves, as it is at 1 um; loaded teeth deflect by 5 to 30 um.
"""


FINEST = 1e-6
"""Least tolerance over the largest transmission error: below it rounding comes near."""


def with_tolerance_to_scale(system: System) -> System:
    """Return a system whose step tolerance fits the size of its transmission errors."""
    largest, integration = _largest_error(system), system.scene.integration
    scaled = max(integration.tolerance * largest / USUAL_DEFLECTION, FINEST * largest)
    if largest == 0.0 or scaled >= integration.tolerance:  # nothing moves, or it fits as it is
        return system
    smaller = replace(integration, tolerance=scaled)
    return replace(system, scene=replace(system.scene, integration=smaller))


def _largest_error(system: System) -> float:
    """Return the largest deflection under the nominal force or deviation without load of a mesh, m."""
    flanks = system.flanks
    deflection = flanks.nominal_force / np.maximum(flanks.mean_stiffness, 1e-300)
    deviation: list[FloatArray] = [np.ptp(table.deflection[..., 0], axis=-1) for table in flanks.tables]
    largest = [float(np.max(part, initial=0.0)) for part in (deflection, *deviation)]
    return max(largest, default=0.0)
