"""Speeds of planetary sets and coupled trains (Willis), several drives, what is refused."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from planetary_scenes import driven_scene, planetary_scene, published_set

from dynamics.errors import InputError
from dynamics.joints import FreeRotation, ImposedRotation
from dynamics.loads import TimeLaw
from dynamics.mechanism.kinematics import solve_kinematics

GEARS = published_set(3)
SUN, PLANET, RING = GEARS.teeth


def drive(shaft, speed=100.0):
    return ImposedRotation(f"{shaft} drive", shaft, TimeLaw.constant(speed))


def ratios(*shafts):
    """Ratios of sun, ring, carrier, planet 1 to the speeds imposed on `shafts`."""
    scene = replace(driven_scene(GEARS), drives=tuple(drive(s, 60.0 + 10 * i) for i, s in enumerate(shafts)))
    return solve_kinematics(scene).ratio


@pytest.mark.parametrize(
    "pair", [("sun", "ring"), ("sun", "carrier"), ("carrier", "ring"), ("planet 1", "ring")]
)
def test_two_speeds_set_all_others_by_willis(pair):
    """z_s (w_s - w_c) + z_r (w_r - w_c) = 0 and z_s (w_s - w_c) + z_p (w_p - w_c) = 0 for each law."""
    rows = ratios(*pair)
    for law in range(2):
        sun, ring, carrier, *planets = (row[law] for row in rows)
        assert SUN * (sun - carrier) == -RING * (ring - carrier)
        assert all(SUN * (sun - carrier) == -PLANET * (planet - carrier) for planet in planets)


def test_a_held_ring_gives_the_textbook_ratio():
    rows = ratios("sun", "ring")
    assert rows[2][0] == Fraction(SUN, SUN + RING)
    assert rows[1] == (0, 1)


def test_mesh_rate_is_that_of_the_sun_against_its_carrier():
    rate = solve_kinematics(driven_scene(GEARS)).mesh_rate
    assert {row[0] for row in rate} == {SUN * (1 - Fraction(SUN, SUN + RING))}


def test_a_third_drive_is_refused():
    scene = driven_scene(GEARS)
    with pytest.raises(InputError, match=r"drives\[2\]\.shaft.*no other drive sets"):
        solve_kinematics(replace(scene, drives=(*scene.drives, drive("carrier", 3.0))))


def test_too_few_drives_are_refused_and_a_free_rotation_helps():
    scene = replace(driven_scene(GEARS), drives=(drive("sun"),))
    with pytest.raises(InputError, match=r"shafts\[1\].*ring.*free rotation"):
        solve_kinematics(scene)
    free = solve_kinematics(replace(scene, free_rotations=(FreeRotation("f", "carrier", 20.0),)))
    assert free.imposed == {0}
    assert free.ratio[2] == (0, 1)


def test_a_mesh_that_turns_with_its_carrier_is_refused():
    speeds = (drive("sun", 50.0), drive("carrier", 50.0))
    with pytest.raises(InputError, match="turns against its carrier"):
        solve_kinematics(replace(driven_scene(GEARS), drives=speeds))


def test_gears_in_different_frames_do_not_mesh():
    scene = planetary_scene(GEARS)
    fixed = (replace(scene.shafts[0], frame=None), *scene.shafts[1:])
    with pytest.raises(InputError, match=r"meshes\[0\]\.driven.*same frame"):
        solve_kinematics(replace(scene, shafts=fixed))


def test_planets_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match=r"planets = 4.*divisor of z_sun \+ z_ring = 126"):
        published_set(4, teeth=TEETH_OF_THREE)
    with pytest.raises(InputError, match=r"angles\[1\].*2\.0943951"):
        published_set(3, angles=(0.0, 2.1, 4.2))


TEETH_OF_THREE = published_set(3).teeth


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"frame": "nobody"}, r"shafts\[0\]\.frame"),
        ({"frame": "planet 1"}, r"shafts\[0\]\.frame"),
        ({"origin": (0.01, 0.0, 0.0)}, r"bushings\[0\]\.shaft"),
    ],
)
def test_frames_are_those_of_carriers(change, field):
    scene = planetary_scene(GEARS)
    with pytest.raises(InputError, match=field):
        replace(scene, shafts=(replace(scene.shafts[0], **change), *scene.shafts[1:]))
