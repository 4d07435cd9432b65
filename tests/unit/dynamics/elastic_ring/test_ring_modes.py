"""Natural modes of an elastic ring: thin rings in closed form, thick ones by finite elements, supports."""

import math

import numpy as np
import pytest
from rings import LUGS, RADIUS, annulus_elements, ring_of
from scipy.sparse.linalg import eigsh

from dynamics.elastic_ring.ring_modes import ring_modes
from dynamics.elastic_ring.ring_support import RingSupport

FREE = RingSupport()


def thin(ring, n):
    """Return the frequency of an inextensional mode of a thin ring, Hz."""
    inertia, area = ring.width * ring.height**3 / 12.0, ring.width * ring.height
    stiff = ring.youngs_modulus * inertia / (ring.density * area * RADIUS**4)
    return math.sqrt(stiff * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)) / (2.0 * math.pi)


def test_a_free_thin_ring_has_the_modes_of_the_textbook():
    modes = ring_modes(ring_of(0.01), FREE, 11)
    assert modes.frequency[:3] == pytest.approx(np.zeros(3), abs=1e-2 * modes.frequency[3])
    for n in (2, 3, 4, 5):
        pair = modes.frequency[3 + 2 * (n - 2) : 5 + 2 * (n - 2)]
        assert pair == pytest.approx(np.full(2, thin(ring_of(0.01), n)), rel=1e-3)
        assert list(modes.harmonic[3 + 2 * (n - 2) : 5 + 2 * (n - 2)]) == [n, n]


def free_modes(ring):
    """Return the natural frequencies of a free annulus in plane stress by quadratic elements, Hz."""
    stiffness, mass, _ = annulus_elements(ring)
    square = eigsh(stiffness, 13, mass, sigma=-1e6, return_eigenvectors=False)
    return np.sqrt(np.sort(np.maximum(square, 0.0))[3:]) / (2.0 * np.pi)


@pytest.mark.parametrize("slenderness", [0.1, 0.25])
def test_a_free_thick_ring_has_the_modes_of_finite_elements(slenderness):
    ring = ring_of(slenderness)
    modes = ring_modes(ring, FREE, 11).frequency[3:]
    assert modes == pytest.approx(free_modes(ring)[:8], rel=5e-3)


def test_a_fit_all_around_adds_its_stiffness_to_each_harmonic():
    """With no tangential stiffness and n = 0 the ring breathes: the square rises by k / m."""
    ring, stiffness = ring_of(0.02), 5e9
    breathing = RingSupport(fit_radial=stiffness, fit_tangential=1e3)
    modes = ring_modes(ring, breathing, 40)
    (number,) = [k for k in range(40) if modes.harmonic[k] == 0 and modes.frequency[k] > 100.0]
    area = ring.width * ring.height
    mass = 2.0 * np.pi * RADIUS * area * ring.density
    hoop = 2.0 * np.pi * ring.youngs_modulus * area / RADIUS
    expected = math.sqrt((hoop + stiffness) / mass) / (2.0 * math.pi)
    assert modes.frequency[number] == pytest.approx(expected, rel=1e-3)


def test_lugs_split_the_pairs_that_have_half_as_many_waves():
    """Of 8 lugs the mode of 4 waves has its bellies at the lugs or between them; others stay pairs."""
    modes = ring_modes(ring_of(0.12), LUGS, 10)
    split = modes.frequency[modes.harmonic == 4]
    assert split[1] > 1.1 * split[0]
    for n in (2, 3):
        first, second = modes.frequency[modes.harmonic == n][:2]
        assert first == pytest.approx(second, rel=1e-9)


def test_a_support_raises_every_frequency():
    ring = ring_of(0.12)
    free, held = (ring_modes(ring, support, 12).frequency for support in (FREE, LUGS))
    assert np.all(held >= free - 1e-6 * free[-1])


@pytest.mark.parametrize("stiffness", [2e8, 2e9, 2e10])
@pytest.mark.parametrize("lugs", [4, 8])
def test_modes_on_stiff_lugs_have_converged(monkeypatch, lugs, stiffness):
    """With the harmonics that follow statically, four times as many change no frequency by 0.1 %."""
    ring = ring_of(0.12)
    support = RingSupport(lugs=lugs, lug_radial=stiffness, lug_tangential=stiffness)
    usual = ring_modes(ring, support, 12).frequency
    monkeypatch.setattr("dynamics.elastic_ring.ring_modes.LEAST", 96)
    assert usual == pytest.approx(ring_modes(ring, support, 12).frequency, rel=1e-3)
