"""Gyroscopic and frame terms over speed, from those at two speeds."""

from __future__ import annotations

import numpy as np
from planetary_scenes import planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.linearize.campbell import terms_at
from dynamics.linearize.operating_speeds import law_speeds
from dynamics.linearize.steady_vibration import gyroscopic_terms


def test_terms_at_every_speed_are_those_of_that_speed_alone() -> None:
    system = assemble(planetary_scene(published_set(3), duration=0.01))
    speeds = np.array([3.0, -40.0, 250.0])
    for speed, (damping, stiffness) in zip(speeds, gyroscopic_terms(system, speeds), strict=True):
        gyroscopic, stiffening = terms_at(system, law_speeds(system, abs(float(speed))))
        assert np.abs(gyroscopic).max() > 0.0 < np.abs(stiffening).max()
        np.testing.assert_allclose(damping, gyroscopic, rtol=1e-12, atol=1e-12 * np.abs(gyroscopic).max())
        scale = np.abs(stiffening).max()
        np.testing.assert_allclose(stiffness, stiffening, rtol=1e-10, atol=1e-10 * scale)
