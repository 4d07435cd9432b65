"""Sound power of a scene: closed form of a rigid sphere, scaling, superposition, shares, its file."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table
from hulls import box, sphere
from sounding_housings import (
    NAMES,
    part_of_scene,
    random_housing,
    rigid_housing,
    smooth_motion,
    with_surface,
)

from dynamics.acoustics import Air, ElementalRadiators, EquivalentRadiatedPower, monopoles_efficiency
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import forced_response
from dynamics.noise import RadiatedSound, housing_radiation, radiated_sound

ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
SPEEDS = np.array([60.0, 150.0, 420.0])
AIR = Air()


@cache
def housing():
    bare, hull = random_housing(), box((0.36, 0.24, 0.18), (9, 6, 5))
    return with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness)))


@cache
def response():
    scene = gear_pair_scene(square_wave_table(), effects=ON)
    return forced_response(assemble(replace(scene, housings=(part_of_scene(housing()),))), SPEEDS, orders=4)


@cache
def radiation():
    return housing_radiation(housing(), ElementalRadiators(), response().frequency, AIR)


@cache
def sound() -> RadiatedSound:
    return radiated_sound(response(), housing(), None, radiation())


def scaled(factor: float, bearings=slice(None)):
    force = np.array(response().bearing_force)
    force[bearings] *= factor
    return replace(response(), bearing_force=force)


def test_power_goes_with_the_square_of_the_force() -> None:
    twice = radiated_sound(scaled(2.0), housing(), None, radiation())
    np.testing.assert_allclose(twice.power, 4.0 * sound().power, rtol=1e-9)
    np.testing.assert_allclose(twice.orders.level - sound().orders.level, 20.0 * np.log10(2.0), atol=1e-8)
    np.testing.assert_allclose(twice.efficiency, sound().efficiency, rtol=1e-9)


@pytest.mark.parametrize("index", range(4))
def test_the_share_of_a_bearing_is_what_its_force_does(index: int) -> None:
    own = response().bearing.index(NAMES[index])
    others = [b for b in range(len(response().bearing)) if b != own]
    alone = radiated_sound(scaled(0.0, others), housing(), None, radiation())
    without = radiated_sound(scaled(0.0, own), housing(), None, radiation())
    scale = 1e-9 * sound().power.max()
    np.testing.assert_allclose(alone.power, sound().bearing_alone[index], rtol=1e-9, atol=scale)
    np.testing.assert_allclose(without.power, sound().without_bearing[index], rtol=1e-9, atol=scale)


def test_shares_add_up_to_the_power() -> None:
    np.testing.assert_allclose(sound().bearing_share.sum(axis=0), sound().power, rtol=1e-9)
    kept = len(housing().frequency)
    assert sound().mode_share.shape[0] == kept
    if kept == len(housing().stiffness):
        np.testing.assert_allclose(sound().mode_share.sum(axis=0), sound().power, rtol=1e-9)


def test_third_octaves_add_up_to_the_total() -> None:
    orders = sound().orders
    np.testing.assert_allclose(orders.third_octaves()[1].sum(axis=0), orders.power.sum(axis=0), rtol=1e-12)


def oscillating(mass: float, stiffness: float):
    """A rigid sphere of radius 0.1 m on springs, under forces on its one bearing, and what theory says."""
    radius, damping, hertz = 0.1, 0.02, np.array([[150.0, 400.0], [300.0, 800.0]])
    body = rigid_housing(mass, stiffness, damping, sphere(16, radius))
    signals = np.zeros((1, 6, 2, 2), dtype=complex)
    signals[0, 1] = 3.0  # N, along y
    driven = replace(
        response(),
        bearing=("seat",),
        bearing_force=signals,
        frequency=hertz,
        speed=SPEEDS[:2],
        order=np.array([1.0, 2.0]),
        least_mesh_force=np.ones((1, 2)),
    )
    omega = 2.0 * np.pi * hertz
    loss = 2.0 * damping * np.sqrt(stiffness * mass)
    velocity = 3.0 * omega / np.abs(stiffness - mass * omega**2 + 1j * omega * loss)
    plane = AIR.impedance * 4.0 * np.pi * radius**2 * velocity**2 / 6.0  # mean of cos^2, half for the peak
    return body, driven, plane, omega / AIR.sound_speed * radius


def test_a_rigid_sphere_on_springs_radiates_as_theory_says() -> None:
    body, driven, plane, ka = oscillating(5.0, 5.0 * (2.0 * np.pi * 250.0) ** 2)
    by_plane = housing_radiation(body, EquivalentRadiatedPower(), driven.frequency)
    found = radiated_sound(driven, body, None, by_plane)
    np.testing.assert_allclose(found.power, plane, rtol=0.03)  # panels of a sphere, 0.1 dB between knots
    np.testing.assert_allclose(found.efficiency, 1.0, rtol=0.03)
    monopoles = housing_radiation(body, ElementalRadiators(), driven.frequency)
    found = radiated_sound(driven, body, None, monopoles)
    expected = np.vectorize(lambda x: monopoles_efficiency(1, x))(ka)
    np.testing.assert_allclose(found.efficiency, expected, rtol=0.03)
    np.testing.assert_allclose(found.power, plane * expected, rtol=0.04)
    assert found.natural_frequency == pytest.approx([250.0] * 3)


def test_without_mass_to_speak_of_the_hull_follows_its_springs() -> None:
    stiffness = 1e6
    body, driven, _, _ = oscillating(1e-9, stiffness)
    found = radiated_sound(
        driven, body, None, housing_radiation(body, EquivalentRadiatedPower(), driven.frequency)
    )
    velocity = 3.0 * 2.0 * np.pi * driven.frequency / stiffness
    area = body.surface.normal_displacement()[1].sum()
    np.testing.assert_allclose(found.power, AIR.impedance * area * velocity**2 / 6.0, rtol=0.03)


def test_a_result_comes_back_from_its_file_as_it_was(tmp_path) -> None:
    sound().to_netcdf(tmp_path / "sound.nc")
    again = RadiatedSound.from_netcdf(tmp_path / "sound.nc")
    for name in RadiatedSound.ARRAYS:
        np.testing.assert_array_equal(getattr(again, name), getattr(sound(), name))
    assert (again.housing, again.bearing, again.facts) == (("housing",), NAMES, sound().facts)


def test_what_does_not_belong_together_is_refused() -> None:
    body = oscillating(1.0, 1e6)[0]
    with pytest.raises(InputError, match="radiation"):
        radiated_sound(response(), body, ("input.left",), radiation())
    with pytest.raises(InputError, match="housing with a surface"):
        housing_radiation(random_housing(), ElementalRadiators(), [100.0])
    high = replace(response(), frequency=10.0 * response().frequency)
    with pytest.raises(InputError, match="frequency"):
        radiated_sound(high, housing(), None, radiation())
