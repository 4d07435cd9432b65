"""Sound power by panels and by regions of a hull: they add up to the power of the map."""

import numpy as np
import pytest
from hulls import box, sphere
from sounding_scene import AIR, housing, radiation, response, sound

from dynamics.acoustics import ElementalRadiators, EquivalentRadiatedPower
from dynamics.housings.reduced_housing import PointMotion
from dynamics.noise import PanelSound, housing_radiation, panel_sound, radiated_sound, regions

MONOPOLES, PLANE = ElementalRadiators(), EquivalentRadiatedPower()
SIDES = np.array([0.3, 0.2, 0.1])


def test_panels_add_up_to_the_power_at_every_speed_and_order():
    """Below and above the frequency that the panels resolve, and between computed frequencies."""
    resolved, power = radiation().metadata.resolved_frequency, sound().power
    beyond = sound().frequency > resolved
    assert 0 < beyond.sum() < beyond.size
    for at in np.ndindex(power.shape):
        panels = panel_sound(response(), housing(), None, radiation(), at, MONOPOLES, AIR)
        assert panels.power.sum() == pytest.approx(power[at], rel=1e-9)
        if beyond[at]:
            assert panels.power.min() >= 0.0  # equivalent radiated power


def test_panels_of_equivalent_radiated_power_go_by_the_square_of_their_velocity():
    plane = housing_radiation(housing(), PLANE, response().frequency, AIR)
    found = radiated_sound(response(), housing(), None, plane)
    for at in ((0, 0), (2, 3)):
        panels = panel_sound(response(), housing(), None, plane, at, PLANE, AIR)
        assert panels.power.sum() == pytest.approx(found.power[at], rel=1e-9)
        np.testing.assert_allclose(panels.intensity * panels.hull.areas, panels.power, rtol=1e-12)


def test_the_regions_of_a_box_are_its_walls():
    hull = box(SIDES, (6, 4, 3))
    power = np.where(hull.normals[:, 1] > 0.5, 2.0, -0.1) * hull.areas
    cover = PointMotion("cover", np.array([0.01, 0.1, 0.02]), np.zeros((3, 1)))
    found = regions(PanelSound(hull, power), (cover,))
    assert {region.facing for region in found} == {"+x", "-x", "+y", "-y", "+z", "-z"}
    loudest, *others = found
    assert (loudest.facing, loudest.points) == ("+y", ("cover",))
    assert all(region.points == () for region in others)
    np.testing.assert_allclose(loudest.normal, [0.0, 1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(loudest.center, [0.0, 0.1, 0.0], atol=1e-12)
    assert loudest.area == pytest.approx(0.3 * 0.1)
    assert loudest.power == pytest.approx(2.0 * 0.3 * 0.1)
    assert sum(region.power for region in found) == pytest.approx(power.sum(), rel=1e-12)


def test_regions_of_any_hull_hold_all_of_its_area_and_power():
    hull = sphere(7, 0.1)
    power = np.random.default_rng(1).normal(size=len(hull.areas))
    found = regions(PanelSound(hull, power))
    assert sum(region.area for region in found) == pytest.approx(hull.area, rel=1e-12)
    assert sum(region.power for region in found) == pytest.approx(power.sum(), rel=1e-9)
    for region in found:
        assert "xyz"[np.argmax(np.abs(region.normal))] == region.facing[1]


def test_edges_of_a_plate_join_its_faces():
    hull = box((0.3, 0.2, 0.002), (6, 4, 1))
    found = regions(PanelSound(hull, hull.areas))
    assert {region.facing for region in found} == {"+z", "-z"}
    assert sum(region.area for region in found) == pytest.approx(hull.area, rel=1e-12)
