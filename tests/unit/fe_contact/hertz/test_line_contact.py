"""Laws of line contact and of the contact at a tip edge: equilibrium, scaling, limits."""

import math

import numpy as np
import pytest
from hertz_laws import edge_contact_length, edge_half_width, line_load_at_half_width, local_approach
from scipy.integrate import quad

from fe_contact.hertz import contact_modulus, half_width, peak_pressure, relative_radius, wedge_softness
from fe_contact.material import STEEL, Material

MODULUS = contact_modulus(STEEL, STEEL)
LOADS = np.geomspace(1e2, 1e7, 11)


def test_contact_modulus_is_symmetric_and_follows_the_soft_body():
    assert pytest.approx(0.5 * STEEL.plane_strain_modulus, rel=1e-15, abs=0.0) == MODULUS
    plastic = Material(2e9, 0.4)
    assert contact_modulus(plastic, STEEL) == contact_modulus(STEEL, plastic)
    assert contact_modulus(plastic, plastic) < contact_modulus(plastic, STEEL) < plastic.plane_strain_modulus


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [(2.0, 3.0, 1.2), (5.0, math.inf, 5.0), (math.inf, 5.0, 5.0), (2.0, -3.0, 6.0), (0.0, 3.0, 0.0)],
)
def test_relative_radius(first, second, expected):
    assert relative_radius(first, second) == pytest.approx(expected, rel=1e-15, abs=0.0)


def test_width_load_and_pressure_are_tied_and_scale_with_size():
    assert line_load_at_half_width(half_width(LOADS, 6e-3, MODULUS), 6e-3, MODULUS) == pytest.approx(
        LOADS, rel=1e-14, abs=0.0
    )
    width, pressure = half_width(LOADS, 6e-3, MODULUS), peak_pressure(LOADS, 6e-3, MODULUS)
    assert 0.5 * math.pi * width * pressure == pytest.approx(LOADS, rel=1e-14, abs=0.0)
    s = 3.7
    width = half_width(LOADS, 6e-3, MODULUS)
    assert half_width(s * LOADS, s * 6e-3, MODULUS) == pytest.approx(s * width, rel=1e-14, abs=0.0)
    assert peak_pressure(s * LOADS, s * 6e-3, MODULUS) == pytest.approx(
        peak_pressure(LOADS, 6e-3, MODULUS), rel=1e-14, abs=0.0
    )
    small = local_approach(LOADS, 3e-4, width, STEEL)
    assert local_approach(s * LOADS, s * 3e-4, s * width, STEEL) == pytest.approx(
        s * small, rel=1e-13, abs=0.0
    )


def test_local_approach_is_the_difference_of_two_half_plane_solutions():
    # A half-plane under pressure q moves by -(2 (1 - nu^2)/(pi E)) * integral of q ln|x - s| ds + constant.
    # Hertz strip: at its center; patch of the finite-element model: mean weighted by it; same constant.
    p, a, b = 1e5, 3e-4, 1e-4
    k = 2.0 / (math.pi * STEEL.plane_strain_modulus)

    def semi_ellipse(x, half):
        return 2.0 / (math.pi * half) * math.sqrt(max(1.0 - (x / half) ** 2, 0.0))

    def mean_log(x, half):
        def integrand(angle):
            return math.cos(angle) ** 2 * 2.0 / math.pi * math.log(abs(x - half * math.sin(angle)) + 1e-300)

        here = math.asin(max(-1.0, min(1.0, x / half)))
        return sum(
            quad(integrand, *ends, limit=200)[0] for ends in ((-math.pi / 2, here), (here, math.pi / 2))
        )

    hertz = -k * p * mean_log(0.0, b)
    patch = -k * p * 2.0 * quad(lambda x: semi_ellipse(x, a) * mean_log(x, a), 0.0, a, epsrel=1e-9)[0]
    assert local_approach(p, a, b, STEEL) == pytest.approx(hertz - patch, rel=1e-7, abs=0.0)


def test_local_approach_vanishes_without_load_and_knows_no_patch_in_differences():
    approach = local_approach(np.array([0.0, 1e5]), 3e-4, half_width([0.0, 1e5], 6e-3, MODULUS), STEEL)
    assert approach[0] == 0.0
    assert approach[1] > 0.0
    width = half_width(LOADS, 6e-3, MODULUS)
    k = 2.0 / (math.pi * STEEL.plane_strain_modulus)
    difference = local_approach(LOADS, 4e-4, width, STEEL) - local_approach(LOADS, 2e-4, width, STEEL)
    assert difference == pytest.approx(k * LOADS * math.log(2.0), rel=1e-12, abs=0.0)


EDGE_MODULUS, RADIUS = 115e9, 6e-3
EDGE_LOADS = np.geomspace(1e2, 1e7, 21)
SLOPES = [0.3, 0.02, 1e-4, 0.0, -1e-4, -0.02]


@pytest.mark.parametrize("slope", SLOPES)
def test_length_satisfies_equilibrium(slope):
    c = edge_contact_length(EDGE_LOADS, slope, RADIUS, EDGE_MODULUS)
    carried = 0.25 * math.pi * EDGE_MODULUS * c * (slope + 0.75 * c / RADIUS)
    assert carried == pytest.approx(EDGE_LOADS, rel=1e-10, abs=0.0)


def test_parallel_and_blunt_edges_keep_their_digits():
    assert edge_contact_length(1e-6, 0.3, RADIUS, EDGE_MODULUS) == pytest.approx(
        4e-6 / (math.pi * EDGE_MODULUS * 0.3), rel=1e-12, abs=0.0
    )
    c = edge_contact_length(EDGE_LOADS, 0.0, RADIUS, EDGE_MODULUS)
    assert edge_half_width(c, 0.0, RADIUS) == pytest.approx(0.5 * c, rel=1e-14, abs=0.0)
    assert c == pytest.approx(
        2.0 / math.sqrt(3.0) * half_width(EDGE_LOADS, RADIUS, EDGE_MODULUS), rel=1e-14, abs=0.0
    )
    assert edge_half_width(1e-6, 0.5, 1.0) == pytest.approx(0.5e-6 * math.exp(-0.5), rel=1e-5, abs=0.0)


def test_sharper_wedges_yield_more_than_a_half_plane():
    assert wedge_softness(math.pi) == pytest.approx(1.0, rel=1e-15, abs=0.0)
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
