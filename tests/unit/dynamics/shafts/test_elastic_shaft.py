"""Elastic coordinates of a shaft: closed forms, orthogonality to rigid motion, and the stated errors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dynamics.shafts import BeamSection, Disc, Inertia, PointOfApplication, elastic_shaft, hollow_cylinder

SHAFT = (BeamSection(0.3, 0.04),)
STEPPED = (BeamSection(0.1, 0.03), BeamSection(0.12, 0.05, 0.02), BeamSection(0.08, 0.025))
ENDS = (PointOfApplication(0.0, True, True, True, True), PointOfApplication(0.3, True, True, True, True))
DISC = Disc(0.13, Inertia(2.0, 4e-3, 2.5e-3))


@pytest.mark.parametrize("family", ["torsion", "extension"])
def test_a_free_rod_twists_and_stretches_at_the_frequencies_of_the_closed_form(family):
    """n c/(2 L) with the speed of sound of the family."""
    elastic = elastic_shaft(SHAFT, (), ENDS, 30e3, 0.0)
    section = SHAFT[0]
    modulus = section.shear_modulus if family == "torsion" else section.youngs_modulus
    speed = math.sqrt(modulus / section.density)
    found = getattr(elastic, family).frequency
    count = int(30e3 // (speed / 0.6))
    assert count >= 3
    expected = np.arange(1, count + 1) * speed / 0.6
    assert np.all(np.abs(found[:count] / expected - 1.0) < elastic.mesh_error + elastic.truncation)


def test_a_free_beam_bends_at_the_frequency_of_the_closed_form():
    """22.3733 sqrt(E I/(rho A))/L^2 of a slender one (Euler and Bernoulli)."""
    slender = BeamSection(1.0, 0.01)
    ends = (PointOfApplication(0.0, True, True), PointOfApplication(1.0, True, True))
    elastic = elastic_shaft((slender,), (), ends, 2e3, 0.0)
    speed = math.sqrt(slender.youngs_modulus * slender.second_moment / (slender.density * slender.area))
    assert 2.0 * math.pi * elastic.bending.frequency[0] == pytest.approx(22.37329 * speed, rel=1e-3)


@pytest.mark.parametrize("held", [None, 0.0, 0.3])
def test_elastic_motion_has_no_momentum_but_that_of_a_held_rotation(held):
    elastic = elastic_shaft(
        STEPPED, (DISC,), (*ENDS, PointOfApplication(0.13, True, True, True, True)), 10e3, 0.0, held
    )
    count = elastic.position.size
    assert np.all(elastic.mass > 0.0)
    turn = elastic.torsion.shape.T @ elastic.polar @ np.ones(count)
    scale = np.sum(elastic.polar)
    if held is None:
        assert np.max(np.abs(turn)) < 1e-12 * scale
        assert not np.any(elastic.turned)
    else:
        np.testing.assert_allclose(elastic.turned[elastic.twists], turn, rtol=1e-9, atol=1e-12 * scale)
        np.testing.assert_allclose(elastic.motion(held)[5], 0.0, atol=1e-12)
    total = sum(hollow_cylinder(s.outer_diameter, s.length, s.bore_diameter).polar for s in STEPPED)
    assert scale == pytest.approx(total + DISC.inertia.polar, rel=1e-12)


def test_coordinates_share_no_energy():
    """Modal masses and stiffnesses are all there is: shapes diagonalize the beam's matrices."""
    elastic = elastic_shaft(
        STEPPED, (DISC,), (*ENDS, PointOfApplication(0.13, True, True, True, True)), 10e3, 0.0
    )
    shape, polar = elastic.torsion.shape, elastic.polar
    mass = shape.T @ polar @ shape
    rounding = np.finfo(float).eps * np.linalg.cond(polar)  # of a Cholesky factor, relative
    np.testing.assert_allclose(mass, np.diag(elastic.torsion.mass), atol=rounding * np.max(mass))


@pytest.mark.parametrize("highest", [1e3, 20e3])
def test_static_twist_does_not_depend_on_the_modes_kept(highest):
    """Equal and opposite torques at both ends: T L/(G J) piece by piece."""
    elastic = elastic_shaft(STEPPED, (DISC,), ENDS, highest, 0.0)
    arm = elastic.motion(0.3)[5] - elastic.motion(0.0)[5]
    piece = [s.length / (s.shear_modulus * 2.0 * s.second_moment) for s in STEPPED]
    assert float(arm**2 @ (1.0 / elastic.stiffness)) == pytest.approx(sum(piece), rel=1e-9, abs=0.0)


@pytest.mark.law
def test_the_stated_error_of_the_elements_is_that_of_the_frequencies():
    """Against the closed form of a free rod, whose modes with free ends all lie below the limit."""
    elastic = elastic_shaft(SHAFT, (), ENDS, 60e3, 0.0)
    speed = math.sqrt(SHAFT[0].shear_modulus / SHAFT[0].density)
    count = int(60e3 // (speed / 0.6))
    exact = np.arange(1, count + 1) * speed / 0.6
    worst = np.max(np.abs(elastic.torsion.frequency[:count] / exact - 1.0))
    assert 0.0 < elastic.mesh_error <= 1e-3
    assert worst < elastic.mesh_error + elastic.truncation


def test_a_higher_frequency_of_interest_keeps_more_modes_and_takes_shorter_elements():
    coarse, fine = (elastic_shaft(STEPPED, (DISC,), ENDS, f, 0.0) for f in (2e3, 30e3))
    assert fine.bending.fixed > coarse.bending.fixed
    assert fine.position.size > coarse.position.size
    assert max(coarse.truncation, fine.truncation) <= 0.01


def test_damping_is_the_ratio_of_every_coordinate():
    elastic = elastic_shaft(STEPPED, (DISC,), ENDS, 5e3, 0.02)
    np.testing.assert_allclose(elastic.damping / (2.0 * np.sqrt(elastic.mass * elastic.stiffness)), 0.02)


def test_both_planes_bend_alike():
    """u_x' = tilt_y and u_y' = -tilt_x at every node."""
    elastic = elastic_shaft(STEPPED, (DISC,), ENDS, 5e3, 0.0)
    b = elastic.bending.mass.size
    rows = elastic.motion(0.3)
    np.testing.assert_array_equal(rows[0, :b], rows[1, b : 2 * b])
    np.testing.assert_array_equal(rows[4, :b], -rows[3, b : 2 * b])
    assert np.any(rows[0, :b] != 0.0)
