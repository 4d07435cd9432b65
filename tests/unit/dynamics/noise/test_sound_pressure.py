"""Sound pressure at a microphone: closed forms, its sound power, superposition, distance, delay."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hulls import box, sphere
from reduced_housings import PAIR, bare_housing
from sounding_housings import rigid_housing, smooth_motion, with_surface
from sounding_scene import response

from dynamics.acoustics import Air, ElementalRadiators, Hull, outer_hull
from dynamics.acoustics.air import directions
from dynamics.errors import InputError
from dynamics.noise import housing_radiation, pressure_signal, pressure_transfer, radiated_sound, sound_limit
from dynamics.noise.housing_recordings import sound_paths
from dynamics.vibration import seat_forces

AIR, FREE, BAFFLED = Air(), ElementalRadiators(), ElementalRadiators(baffled=True)
RATE, AWAY = 64_000.0, np.array([0.7, -0.4, 0.5])
RADIUS = 0.1


@cache
def housing():
    bare, hull = bare_housing(), box((0.36, 0.24, 0.18), (9, 6, 5))
    return with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness)))


def harmonic(hertz: float, samples: int, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times, and a force (s,) on the seats that rises slowly from zero to a steady harmonic."""
    time = np.arange(samples) / RATE
    rise = 0.5 - 0.5 * np.cos(np.pi * np.minimum(time / 0.05, 1.0))
    return time, np.outer(rise * np.cos(2.0 * np.pi * hertz * time), force)


def amplitude(samples: np.ndarray, hertz: float) -> complex:
    """Complex peak amplitude over the last tenth of a second, a whole number of periods."""
    time = np.arange(samples.size)[-round(0.1 * RATE) :] / RATE
    return complex(2.0 * np.mean(samples[-time.size :] * np.exp(-2j * np.pi * hertz * time)))


@pytest.mark.parametrize("ka", [0.1, 1.0, 2.5])
def test_a_pulsating_sphere_of_monopoles(ka: float) -> None:
    """A layer of monopoles on a sphere: i k rho c Q/(4 pi r) e^{-ikr} sin(ka)/(ka), near to it too."""
    hull, k = sphere(12, RADIUS), ka / RADIUS
    hertz = k * AIR.sound_speed / (2.0 * np.pi)
    for distance in (1.5 * RADIUS, 20.0 * RADIUS):
        paths = sound_paths(hull, np.ones((len(hull.areas), 1)), np.array([0.0, 0.0, distance]), FREE, AIR)
        per_acceleration = paths.transfer(np.array([hertz]))[0, 0]
        outgoing = AIR.density * hull.area * np.exp(-1j * k * distance) / (4.0 * np.pi * distance)
        assert per_acceleration == pytest.approx(outgoing * np.sin(ka) / ka, rel=0.01)
        if ka == 0.1:  # the sphere itself, which scatters
            surface = AIR.density * RADIUS**2 * np.exp(-1j * k * (distance - RADIUS)) / distance
            assert abs(per_acceleration) == pytest.approx(abs(surface / (1.0 + 1j * ka)), rel=0.01)


def test_a_piston_in_a_baffle_on_its_axis() -> None:
    """2 rho c v sin(k/2 (sqrt(h^2 + a^2) - h)): near field, minima and all."""
    ring = np.linspace(0.0, RADIUS, 41)
    nodes, triangles = [(0.0, 0.0, 0.0)], []
    turn = np.linspace(0.0, 2.0 * np.pi, 120, endpoint=False)
    nodes += [(r * np.cos(a), r * np.sin(a), 0.0) for r in ring[1:] for a in turn]
    for i in range(turn.size):
        j = (i + 1) % turn.size
        triangles.append((0, 1 + i, 1 + j))
        for n in range(ring.size - 2):
            p, q = 1 + n * turn.size, 1 + (n + 1) * turn.size
            triangles += [(p + i, q + i, q + j), (p + i, q + j, p + j)]
    piston = Hull(np.array(nodes), np.array(triangles))
    hertz = np.array([500.0, 2000.0, 6000.0])
    k = 2.0 * np.pi * hertz / AIR.sound_speed
    for height in (0.03, 0.1, 1.0):
        paths = sound_paths(piston, np.ones((len(triangles), 1)), np.array([0, 0, height]), BAFFLED, AIR)
        pressure = 2.0 * np.pi * hertz * np.abs(paths.transfer(hertz)[:, 0])
        expected = 2.0 * AIR.impedance * np.abs(np.sin(0.5 * k * (np.hypot(height, RADIUS) - height)))
        np.testing.assert_allclose(pressure, expected, atol=0.005 * 2.0 * AIR.impedance)


def test_what_passes_a_sphere_far_away_is_the_sound_power() -> None:
    body, hertz = housing(), 700.0
    driven = response_at(hertz)
    radiation = housing_radiation(body, FREE, [hertz])  # whose middle is computed, not interpolated
    power = radiated_sound(driven, body, None, radiation).power[0, 0]
    force = seat_forces(driven, body)[0, 0]
    vectors, weights = directions(12)
    far = 400.0
    pressure = [pressure_transfer(body, far * vector, np.array([hertz]))[0] @ force for vector in vectors]
    passed = far**2 * weights @ np.abs(pressure) ** 2 / (2.0 * AIR.impedance)
    assert passed == pytest.approx(power, rel=0.01)


def response_at(hertz: float):
    """The response of the gear pair, one order of it taken to be at a frequency."""
    known = response()
    return replace(
        known,
        frequency=np.array([[hertz]]),
        speed=known.speed[:1],
        order=known.order[:1],
        bearing_force=known.bearing_force[..., :1, :1],
        least_mesh_force=known.least_mesh_force[:, :1],
    )


@pytest.mark.parametrize("hertz", [310.0, 1200.0, 8000.0])
def test_over_time_it_is_the_force_through_the_transfer_function(hertz: float) -> None:
    body = housing()
    force = np.random.default_rng(5).normal(size=body.motions)
    found = amplitude(pressure_signal(body, *harmonic(hertz, 32_000, force), AWAY), hertz)
    expected = pressure_transfer(body, AWAY, np.array([hertz]))[0] @ force
    assert found == pytest.approx(expected, rel=2e-3)


def test_forces_superpose() -> None:
    body, time = housing(), np.arange(9000) / RATE
    first, second = np.random.default_rng(6).normal(size=(2, time.size, body.motions))
    whole, one, other = (pressure_signal(body, time, f, AWAY) for f in (first + second, first, second))
    np.testing.assert_allclose(whole, one + other, atol=1e-9 * np.abs(whole).max())


def test_far_away_it_falls_with_the_distance_and_comes_later() -> None:
    body, hertz = housing(), np.array([400.0, 1500.0])
    near, far = (pressure_transfer(body, r * AWAY / np.linalg.norm(AWAY), hertz) for r in (100.0, 200.0))
    late = np.exp(-2j * np.pi * hertz * 100.0 / AIR.sound_speed)
    np.testing.assert_allclose(far, 0.5 * near * late[:, None], atol=2e-3 * np.abs(far).max())


def test_nothing_is_heard_before_the_nearest_panel_nor_at_rest() -> None:
    body, time = housing(), np.arange(16_000) / RATE
    constant = np.tile(np.random.default_rng(8).normal(size=body.motions), (time.size, 1))
    assert np.abs(pressure_signal(body, time, constant, AWAY)).max() < 1e-12
    stepped = constant * (time > 0.02)[:, None]
    heard = pressure_signal(body, time, stepped, AWAY)
    nearest = np.linalg.norm(outer_hull(body).hull.centers - AWAY, axis=1).min() / AIR.sound_speed
    before = time < 0.02 + nearest - 20.0 / RATE  # of the spline of the step and of the interpolated delay
    assert np.abs(heard[before]).max() < 1e-4 * np.abs(heard).max()
    assert np.abs(heard[~before][:60]).max() > 0.1 * np.abs(heard).max()
    assert not pressure_signal(body, time, stepped, 1e3 * AWAY).any()  # still on its way


@pytest.mark.law
def test_a_rigid_sphere_oscillates_as_a_dipole_of_monopoles() -> None:
    """On its axis far away rho c k a^2 v j_1(ka)/r: the first harmonic of the layer."""
    body = rigid_housing(5.0, 1e9, 0.01, sphere(12, RADIUS))
    ka, far = 1.2, 50.0
    k = ka / RADIUS
    hertz = k * AIR.sound_speed / (2.0 * np.pi)
    found = pressure_transfer(body, np.array([far, 0.0, 0.0]), np.array([hertz]))[0, 0]
    omega = 2.0 * np.pi * hertz
    mobility = 1j * omega / abs(1e9 - 5.0 * omega**2)
    j1 = np.sin(ka) / ka**2 - np.cos(ka) / ka
    assert abs(found) == pytest.approx(AIR.impedance * k * RADIUS**2 * j1 / far * abs(mobility), rel=0.01)


def test_a_microphone_stands_in_the_air() -> None:
    body = housing()
    frequency = np.array([300.0])
    with pytest.raises(InputError, match="outside of the housing"):
        pressure_transfer(body, np.zeros(3), frequency)
    with pytest.raises(InputError, match="two of its longest edges"):
        pressure_transfer(body, np.array([0.0, 0.0, 0.1]), frequency)
    with pytest.raises(InputError, match="three finite coordinates"):
        pressure_transfer(body, np.array([0.0, np.nan, 1.0]), frequency)
    with pytest.raises(InputError, match="with a surface"):
        pressure_transfer(bare_housing(), AWAY, frequency)


def test_it_is_valid_to_where_modes_and_panels_reach() -> None:
    body = housing()
    panels = outer_hull(body).hull.highest_wavenumber * AIR.sound_speed / (2.0 * np.pi)
    assert sound_limit(body) == pytest.approx(min(0.7 * body.frequency.max(), panels))
    assert set(PAIR) == {seat.name for seat in body.seats}
