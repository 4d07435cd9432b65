"""Sound pressure by boundary elements: spheres in closed form, and what monopoles are off."""

import numpy as np
import pytest
from hulls import box, sphere
from scipy.special import spherical_jn, spherical_yn
from sounding_housings import rigid_housing

from dynamics.acoustics import Air, ElementalRadiators, exterior_pressure
from dynamics.acoustics.air import directions
from dynamics.noise import pressure_transfer, scattered_pressure_transfer
from dynamics.noise.housing_recordings import sound_paths

AIR, RADIUS = Air(), 0.1
PLACES = np.array([[0.0, 0.1, 0.2], [0.3, 0.4, 0.5], [0.0, 5.0, 5.0]])


@pytest.fixture(autouse=True, scope="module")
def _library():
    pytest.importorskip("ngsolve", reason="boundary elements need the extra boundary-elements")


def outgoing(kr: np.ndarray, order: int, *, derivative: bool = False) -> np.ndarray:
    """Spherical Hankel function of e^{+i omega t}."""
    return np.asarray(spherical_jn(order, kr, derivative) - 1j * spherical_yn(order, kr, derivative))


@pytest.mark.parametrize("ka", [0.3, 1.2])
def test_spheres_sound_as_their_harmonics_do_near_and_far(ka):
    """-i rho c h_n(kr)/h_n'(ka) P_n: pulsating and oscillating, with phase."""
    hull, k = sphere(4, RADIUS), ka / RADIUS
    shapes = np.stack([np.ones(len(hull.areas)), hull.normals[:, 2]], axis=1) + 0j
    found = exterior_pressure(hull, k * AIR.sound_speed / (2.0 * np.pi), shapes, PLACES, AIR)
    distance = np.linalg.norm(PLACES, axis=1)
    for order, along in ((0, 1.0), (1, PLACES[:, 2] / distance)):
        radial = outgoing(k * distance, order) / outgoing(np.array(ka), order, derivative=True)
        np.testing.assert_allclose(found[:, order], -1j * AIR.impedance * radial * along, rtol=0.006)


def test_a_rigid_sphere_under_a_force_scatters():
    """The air that an oscillating sphere moves makes it louder than its monopoles: 3/2 at long waves."""
    body = rigid_housing(5.0, 1e9, 0.01, sphere(2, RADIUS))
    hertz = 0.05 / RADIUS * AIR.sound_speed / (2.0 * np.pi)
    place = np.array([0.0, 0.0, 300.0])
    whole = scattered_pressure_transfer(body, place, hertz)[0]
    monopoles = pressure_transfer(body, place, np.array([hertz]))[0]
    assert abs(whole[2] / monopoles[2]) == pytest.approx(1.5, rel=0.01)
    assert abs(whole[0]) < 0.01 * abs(whole[2])


@pytest.mark.law
def test_monopoles_are_off_by_what_the_manual_states():
    """A box 1 m around, 400 Hz, directions within 10 dB of the loudest: -7 to 2 dB."""
    hull = box((0.36, 0.24, 0.18), (9, 6, 4))
    x, y = hull.centers[:, 0] / 0.36, hull.centers[:, 1] / 0.24
    top, bent = hull.normals[:, 2] > 0.9, np.cos(np.pi * y)
    covers = [top * np.cos(np.pi * x) * bent, top * np.sin(2.0 * np.pi * x) * bent]
    shapes = np.stack([np.ones(len(x)), *covers, hull.normals[:, 2]], axis=1)
    places, hertz = directions(5)[0], np.array([400.0])
    whole = np.abs(exterior_pressure(hull, 400.0, shapes + 0j, places, AIR))
    paths = [sound_paths(hull, shapes, place, ElementalRadiators(), AIR) for place in places]
    monopoles = 2.0 * np.pi * 400.0 * np.abs([path.transfer(hertz)[0] for path in paths])
    error = 20.0 * np.log10(monopoles / whole)[whole > np.sqrt(0.1) * whole.max(axis=0)]
    assert -7.0 < error.min() < -4.0
    assert 0.5 < error.max() < 2.5
