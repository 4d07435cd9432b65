"""Laws of the contact at a tip edge; its numbers are verified in tests/verification/test_edge_contact.py."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hertz_laws import edge_contact_length, edge_half_width

from fe_contact.hertz import half_width, wedge_softness

MODULUS, RADIUS = 115e9, 6e-3
LOADS = np.geomspace(1e2, 1e7, 21)
SLOPES = [0.3, 0.02, 1e-4, 0.0, -1e-4, -0.02]


@pytest.mark.parametrize("slope", SLOPES)
def test_length_satisfies_equilibrium(slope):
    c = edge_contact_length(LOADS, slope, RADIUS, MODULUS)
    carried = 0.25 * math.pi * MODULUS * c * (slope + 0.75 * c / RADIUS)
    assert carried == pytest.approx(LOADS, rel=1e-10, abs=0.0)


@pytest.mark.parametrize("slope", SLOPES)
def test_length_grows_with_load(slope):
    assert np.all(np.diff(edge_contact_length(LOADS, slope, RADIUS, MODULUS)) > 0.0)


def test_steep_edge_keeps_its_digits():
    # p -> 0: c = 4 p/(pi E* phi), far below where root - phi would have cancelled
    assert edge_contact_length(1e-6, 0.3, RADIUS, MODULUS) == pytest.approx(
        4e-6 / (math.pi * MODULUS * 0.3), rel=1e-12, abs=0.0
    )


def test_no_load_no_length():
    assert edge_contact_length(0.0, [0.0, 0.02], RADIUS, MODULUS).tolist() == [0.0, 0.0]


def test_lengths_scale_with_size():
    s = 4.2
    for slope in (0.02, 0.0):
        c = edge_contact_length(LOADS, slope, RADIUS, MODULUS)
        assert edge_contact_length(s * LOADS, slope, s * RADIUS, MODULUS) == pytest.approx(
            s * c, rel=1e-13, abs=0.0
        )
        assert edge_half_width(s * c, slope, s * RADIUS) == pytest.approx(
            s * edge_half_width(c, slope, RADIUS), rel=1e-13, abs=0.0
        )


def test_parallel_flanks_at_the_edge():
    # phi = 0: pressure sqrt((c-x)/x)(x + c/2), shares 2 to 1, so w = -1/2 and b_eff = c/2
    c = edge_contact_length(LOADS, 0.0, RADIUS, MODULUS)
    assert edge_half_width(c, 0.0, RADIUS) == pytest.approx(0.5 * c, rel=1e-14, abs=0.0)
    assert c == pytest.approx(2.0 / math.sqrt(3.0) * half_width(LOADS, RADIUS, MODULUS), rel=1e-14, abs=0.0)


def test_blunt_wedge_does_not_know_the_radius():
    # phi R >> c: pressure ~ sqrt((c-x)/x), w = -1
    assert edge_half_width(1e-6, 0.5, 1.0) == pytest.approx(0.5e-6 * math.exp(-0.5), rel=1e-5, abs=0.0)


def test_a_wedge_of_half_a_turn_is_a_half_plane():
    assert wedge_softness(math.pi) == pytest.approx(1.0, rel=1e-15, abs=0.0)


def test_sharper_wedges_yield_more():
    softness = [wedge_softness(math.radians(angle)) for angle in range(180, 60, -5)]
    assert np.all(np.diff(softness) > 0.0)


@pytest.mark.parametrize("angle", [1.3, 0.5 * math.pi, 2.0, 2.6])
def test_the_stresses_of_a_wedge_balance_the_force(angle):
    # radial stress -(softness field)/r over an arc; k_w is half the moduli of axial and transverse force
    theta = np.linspace(-0.5 * angle, 0.5 * angle, 4001)
    normal = math.sin(0.5 * angle), math.cos(0.5 * angle)
    directions = np.cos(theta), np.sin(theta)
    stiff = [np.trapezoid(part**2, theta) for part in directions]
    softness = 0.5 * math.pi * sum(n**2 / each for n, each in zip(normal, stiff, strict=True))
    assert wedge_softness(angle) == pytest.approx(softness, rel=1e-6, abs=0.0)
