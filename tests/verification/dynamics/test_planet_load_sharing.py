"""Load sharing of planets with one displaced pin: static equilibrium against the closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from planetary_scenes import BEARING_STIFFNESS, MESH_STIFFNESS, PRESSURE_ANGLE, planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.integrators import static_equilibrium

ERROR = 20e-6  # m, the pin of planet 1 against the carrier's motion
SUN_FORCE = 8000.0  # N, torque over base radius
FLOATING = 1.0  # N/m

# rigid carrier, ring held; recomputed independently to the digits shown
PUBLISHED = {
    (4, "floating"): [0.280661, 0.219339, 0.280661, 0.219339],
    (5, "fixed"): [0.298114, 0.175471, 0.175471, 0.175471, 0.175471],
}


def shares(planets, sun, error=ERROR):
    """Share of each planet in the load of the sun."""
    gears = published_set(
        planets,
        sun_stiffness=None if sun == "fixed" else FLOATING,
        ring_stiffness=None,
        carrier_stiffness=None,
        pin_errors=((0.0, -error), *[(0.0, 0.0)] * (planets - 1)),
    )
    solution = static_equilibrium(
        assemble(planetary_scene(gears, sun_torque=SUN_FORCE * gears.base_radius[0]))
    )
    assert solution.status.usable
    return solution.mesh_force[::2] / SUN_FORCE, solution.mesh_force[1::2] / SUN_FORCE


def closed_form(planets, sun):
    """L_i = 1/N + X (delta_i1 - w_i/N), w_i = 1 + 2 cos(psi_i) with a floating and 1 with a fixed sun."""
    cosine = math.cos(PRESSURE_ANGLE)
    stiffness = 1.0 / (2.0 / MESH_STIFFNESS + 4.0 * cosine**2 / BEARING_STIFFNESS)
    gain = 2.0 * cosine * stiffness * ERROR / SUN_FORCE
    assert gain == pytest.approx(0.122643, abs=5e-7)
    angle = 2.0 * np.pi * np.arange(planets) / planets
    weight = 1.0 + (2.0 * np.cos(angle) if sun == "floating" else 0.0)
    return 1.0 / planets + gain * ((np.arange(planets) == 0) - weight / planets)


@pytest.mark.parametrize("sun", ["fixed", "floating"])
@pytest.mark.parametrize("planets", [3, 4, 5])
def test_one_displaced_pin(planets, sun, record_figure):
    found, at_the_ring = shares(planets, sun)
    expected = closed_form(planets, sun)
    if (planets, sun) in PUBLISHED:
        np.testing.assert_allclose(expected, PUBLISHED[planets, sun], atol=1e-6)
    error = float(np.max(np.abs(found - expected)))
    record_figure(
        f"planet load sharing, {planets} planets, {sun} sun", error, "at most 1e-4", "1", "closed form"
    )
    assert error < 1e-4
    np.testing.assert_allclose(found, at_the_ring, rtol=1e-9)  # each planet passes on what it gets


def test_a_floating_sun_centers_itself_between_three_planets():
    found, _ = shares(3, "floating")
    np.testing.assert_allclose(found, 1.0 / 3.0, atol=1e-6)
    assert abs(shares(3, "fixed")[0][0] - 1.0 / 3.0) > 0.05
