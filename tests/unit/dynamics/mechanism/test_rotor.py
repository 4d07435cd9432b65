"""A shaft with its gears as one rigid body."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, with_gear

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.mechanism.rotor import build_rotor
from dynamics.shafts import Inertia


def test_steiner_and_center_of_mass():
    scene = with_gear(gear_pair_scene(), 0, position=0.15, inertia=Inertia(2.0, 0.01, 0.02))
    shaft = replace(scene.shafts[0], inertia=Inertia(6.0, 0.1, 0.3))
    rotor = build_rotor(replace(scene, shafts=(shaft, scene.shafts[1])), shaft)
    assert rotor.center[2] == pytest.approx((6.0 * 0.1 + 2.0 * 0.15) / 8.0)
    assert rotor.inertia.polar == pytest.approx(0.11)
    assert rotor.inertia.transverse == pytest.approx(0.32 + 6.0 * 2.0 / 8.0 * 0.05**2)


def test_bushings_hold_the_shaft_as_springs_at_their_positions():
    """Rigid translation and rotation about the middle of equal bushings: the textbook stiffnesses."""
    scene = gear_pair_scene(effects={"tilt": "on", "axial": "on"})
    system = assemble(scene)
    stiffness, names = system.arrays.stiffness, system.freedoms.name
    at = {name: names.index(f"output.{name}") for name in ("x", "y", "z", "tilt_x", "tilt_y", "rotation")}
    assert stiffness[at["x"], at["x"]] == stiffness[at["z"], at["z"]] == pytest.approx(2e8)
    assert stiffness[at["tilt_x"], at["tilt_x"]] == pytest.approx(2 * 1e8 * 0.1**2)
    assert not stiffness[at["rotation"]].any()
    assert stiffness[at["x"], at["tilt_y"]] == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_allclose(stiffness, stiffness.T)


def test_an_uneven_support_couples_displacement_and_tilt():
    scene = gear_pair_scene(effects={"tilt": "on"})
    bushings = (*scene.bushings[:3], replace(scene.bushings[3], radial_stiffness=3e8))
    system = assemble(replace(scene, bushings=bushings))
    names = system.freedoms.name
    coupling = system.arrays.stiffness[names.index("output.x"), names.index("output.tilt_y")]
    assert coupling == pytest.approx(0.1 * (3e8 - 1e8))  # the right end moves by tilt_y * 0.1 along x
    coupling = system.arrays.stiffness[names.index("output.y"), names.index("output.tilt_x")]
    assert coupling == pytest.approx(-0.1 * (3e8 - 1e8))


def test_a_free_direction_without_inertia_is_refused():
    scene = with_gear(gear_pair_scene(), 1, inertia=Inertia())
    shafts = (scene.shafts[0], replace(scene.shafts[1], inertia=Inertia()))
    with pytest.raises(InputError, match=r"shafts\[1\]\.inertia\.polar = 0"):
        assemble(replace(scene, shafts=shafts))
