"""Laws of line contact: scaling, inverse, limits, and the replacement of a finite-element patch by Hertz."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hertz_laws import line_load_at_half_width, local_approach
from scipy.integrate import quad

from fe_contact.hertz import contact_modulus, half_width, peak_pressure, relative_radius
from fe_contact.material import STEEL, Material

MODULUS = contact_modulus(STEEL, STEEL)
LOADS = np.geomspace(1e2, 1e7, 11)


def test_contact_modulus_of_equal_bodies_is_half_the_plane_strain_modulus():
    assert pytest.approx(0.5 * STEEL.plane_strain_modulus, rel=1e-15, abs=0.0) == MODULUS


def test_contact_modulus_is_symmetric_and_follows_the_soft_body():
    plastic = Material(2e9, 0.4)
    assert contact_modulus(plastic, STEEL) == contact_modulus(STEEL, plastic)
    assert contact_modulus(plastic, plastic) < contact_modulus(plastic, STEEL) < plastic.plane_strain_modulus


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [(2.0, 3.0, 1.2), (5.0, math.inf, 5.0), (math.inf, 5.0, 5.0), (2.0, -3.0, 6.0), (0.0, 3.0, 0.0)],
)
def test_relative_radius(first, second, expected):
    assert relative_radius(first, second) == pytest.approx(expected, rel=1e-15, abs=0.0)


def test_half_width_and_load_are_inverse():
    assert line_load_at_half_width(half_width(LOADS, 6e-3, MODULUS), 6e-3, MODULUS) == pytest.approx(
        LOADS, rel=1e-14, abs=0.0
    )


def test_resultant_of_the_strip_is_the_load():
    # p = pi b p0 / 2 ties half-width and peak pressure together
    width, pressure = half_width(LOADS, 6e-3, MODULUS), peak_pressure(LOADS, 6e-3, MODULUS)
    assert 0.5 * math.pi * width * pressure == pytest.approx(LOADS, rel=1e-14, abs=0.0)


def test_lengths_and_loads_scale_with_size_at_equal_pressure():
    # lengths times s, line loads times s: the same pressure, all displacements times s
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

    def semi_ellipse(x: float, half: float) -> float:
        return 2.0 / (math.pi * half) * math.sqrt(max(1.0 - (x / half) ** 2, 0.0))

    def mean_log(x: float, half: float) -> float:
        def integrand(angle: float) -> float:
            return math.cos(angle) ** 2 * 2.0 / math.pi * math.log(abs(x - half * math.sin(angle)) + 1e-300)

        here = math.asin(max(-1.0, min(1.0, x / half)))
        return sum(
            quad(integrand, *ends, limit=200)[0] for ends in ((-math.pi / 2, here), (here, math.pi / 2))
        )

    hertz = -k * p * mean_log(0.0, b)
    patch = -k * p * 2.0 * quad(lambda x: semi_ellipse(x, a) * mean_log(x, a), 0.0, a, epsrel=1e-9)[0]
    assert local_approach(p, a, b, STEEL) == pytest.approx(hertz - patch, rel=1e-7, abs=0.0)


def test_local_approach_of_no_load_is_zero():
    approach = local_approach(np.array([0.0, 1e5]), 3e-4, half_width([0.0, 1e5], 6e-3, MODULUS), STEEL)
    assert approach[0] == 0.0
    assert approach[1] > 0.0


def test_local_approach_does_not_know_the_patch_when_taken_as_a_difference():
    # two loads at one patch: what depends on the patch is k p ln a, the rest is common
    width = half_width(LOADS, 6e-3, MODULUS)
    k = 2.0 / (math.pi * STEEL.plane_strain_modulus)
    difference = local_approach(LOADS, 4e-4, width, STEEL) - local_approach(LOADS, 2e-4, width, STEEL)
    assert difference == pytest.approx(k * LOADS * math.log(2.0), rel=1e-12, abs=0.0)
