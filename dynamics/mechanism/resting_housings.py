"""Housings without mass under bearings that are not linear: their states of rest."""

from __future__ import annotations

import math
from dataclasses import replace

from dynamics.bearings.matrix import matrix_rows
from dynamics.joints import Housing
from dynamics.scene.scene import Scene

FREQUENCY = 2.0 * math.pi * 1000.0
"""Circular frequency that gives a resting housing its mass, rad/s; no motion at rest depends on it."""


def under_laws(scene: Scene) -> tuple[Housing, ...]:
    """Return the housings without mass that carry bearings that are not linear."""
    nonlinear = {law.bushing for law in scene.bearing_laws}
    return tuple(
        part for part in scene.housings if part.mass is None and not nonlinear.isdisjoint(part.bushings)
    )


def resting_housings(scene: Scene) -> tuple[Housing, ...]:
    """Return the housings of `scene` for states of rest.

    A housing without mass under a bearing that is not linear gets the mass K / FREQUENCY^2: forces and
    motions at rest are those of its stiffness, whatever its mass.
    """
    without = under_laws(scene)
    return tuple(_with_mass(part) if part in without else part for part in scene.housings)


def _with_mass(housing: Housing) -> Housing:
    stiffness, damping = housing.matrices()
    return replace(
        housing,
        stiffness=matrix_rows(stiffness),
        damping=None if housing.damping is None else matrix_rows(damping),
        mass=matrix_rows(stiffness / FREQUENCY**2),
    )
