"""Structural modification of a reduced housing, against reductions of the modified mesh."""

from dataclasses import replace

import numpy as np
import pytest
from varied_housing import meshed

from dynamics.errors import InputError
from dynamics.housings import Material, MaterialDamping, receptance, reduced_housing
from dynamics.housings.modification import with_damping, with_frequencies, with_modes, with_mounts


@pytest.fixture(scope="module")
def reduced():
    return reduced_housing(meshed())


@pytest.mark.law
def test_other_mounts_are_those_of_a_new_reduction(reduced):
    found, expected = with_mounts(reduced, 1.7), reduced_housing(meshed(mount=1.7))
    changed = np.abs(expected.frequency / reduced.frequency - 1.0).max()
    assert changed > 0.1
    np.testing.assert_allclose(found.frequency[:16], expected.frequency[:16], rtol=0.01 * changed)
    np.testing.assert_allclose(found.damping_ratio[:16], expected.damping_ratio[:16], atol=1e-4)
    hertz = np.linspace(0.0, 0.7, 8) * expected.frequency[0]
    wanted = receptance(expected, hertz)[:, : reduced.motions]
    miss = receptance(found, hertz)[:, : reduced.motions] - wanted
    assert np.abs(miss).max() < 0.01 * np.abs(wanted).max()
    back = with_mounts(found, 1.0 / 1.7)
    for name in ("stiffness", "damping"):
        own = getattr(reduced, name)
        np.testing.assert_allclose(getattr(back, name), own, atol=1e-8 * np.abs(own).max())


@pytest.mark.law
def test_other_damping_is_that_of_a_new_reduction(reduced):
    other = reduced_housing(replace(meshed(), damping=MaterialDamping(0.05)))
    found = with_damping(reduced, 2.5)
    np.testing.assert_allclose(found.damping, other.damping, atol=1e-9 * np.abs(other.damping).max())
    np.testing.assert_allclose(found.damping_ratio, other.damping_ratio, rtol=1e-9)


def test_other_frequencies_are_those_of_another_modulus(reduced):
    iron = meshed().material
    softer = Material(0.81 * iron.youngs_modulus, iron.poissons_ratio, iron.density)
    other = reduced_housing(replace(meshed(), material=softer))
    found = with_frequencies(reduced, 0.9)
    np.testing.assert_allclose(found.frequency[:16], other.frequency[:16], rtol=2e-3)
    held = replace(meshed(), feet=(replace(meshed().feet[0], mount=None),))
    fixed = reduced_housing(held)
    np.testing.assert_allclose(with_frequencies(fixed, 0.9).frequency, 0.9 * fixed.frequency, rtol=1e-9)
    np.testing.assert_allclose(with_frequencies(fixed, 0.9).damping_ratio, fixed.damping_ratio, rtol=1e-6)


def test_modes_left_out_are_static(reduced):
    half = with_modes(reduced, 12)
    zero = np.zeros(1)
    np.testing.assert_allclose(receptance(half, zero), receptance(reduced, zero), rtol=1e-7, atol=1e-16)
    np.testing.assert_allclose(half.modes[0][:12] / (2.0 * np.pi), reduced.frequency[:12], rtol=1e-6)
    assert half.modes[0][12] / (2.0 * np.pi) > 10.0 * reduced.frequency[12]
    fewer = reduced_housing(meshed(modes=12))
    hertz = np.linspace(0.1, 0.7, 30) * reduced.frequency[11]
    wanted = receptance(fewer, hertz)[:, : reduced.motions]
    miss = receptance(half, hertz)[:, : reduced.motions] - wanted
    assert np.abs(miss).max() < 0.03 * np.abs(wanted).max()


def test_what_cannot_be_modified_is_refused(reduced):
    with pytest.raises(InputError, match="mounts"):
        with_mounts(replace(reduced, mount_stiffness=None), 2.0)
    for change in (with_damping, with_frequencies, with_mounts):
        with pytest.raises(InputError, match="factor"):
            change(reduced, 0.0)
    with pytest.raises(InputError, match="count"):
        with_modes(reduced, 25)
