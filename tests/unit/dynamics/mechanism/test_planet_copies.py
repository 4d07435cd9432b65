"""Several planets from one: the same scene as from the set's numbers, whatever drives what."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from planetary_scenes import driven_scene, planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.mechanism import with_planets
from dynamics.scene import ring_phase
from dynamics.shafts import DiscBody, Inertia


def only_first(scene):
    """The scene with its first planet alone."""
    kept = {"planet 1", "sun", "ring", "carrier"}
    return replace(
        scene,
        shafts=tuple(s for s in scene.shafts if s.name in kept),
        gears=tuple(g for g in scene.gears if g.name in kept),
        planet_bearings=tuple(b for b in scene.planet_bearings if b.shaft in kept),
        meshes=tuple(m for m in scene.meshes if {m.driver, m.driven} <= kept),
    )


@pytest.mark.parametrize(("driver", "sense"), [("sun", "+z"), ("sun", "-z"), ("ring", "+z")])
def test_copies_have_the_phases_and_positions_of_the_set(driver, sense):
    """A sun that turns backwards, and a ring that drives, meet the planets in the other order."""
    teeth = (28, 35, 98)  # a third of a pitch from planet to planet
    gears = published_set(3, teeth=teeth, driver=driver, sun_sense=sense, ring_phase=0.3)
    speed = -100.0 if sense == "-z" else 100.0
    whole = driven_scene(gears)
    sun = replace(whole.drives[0], speed=replace(whole.drives[0].speed, value=(speed,)))
    whole = replace(whole, drives=(sun, whole.drives[1]), loads=())
    copied = with_planets(only_first(whole), "planet 1", 3)
    locations = {tuple(np.round(shaft.origin, 12)) for shaft in whole.shafts}
    assert {tuple(np.round(shaft.origin, 12)) for shaft in copied.shafts} == locations
    assert len(copied.meshes) == 6
    for mesh in whole.meshes:
        twin = next(m for m in copied.meshes if placed(copied, m) == placed(whole, mesh))
        assert (twin.position_offset - mesh.position_offset) % 1.0 == pytest.approx(0.0, abs=1e-9)


def test_discs_of_a_planet_are_on_all_planets():
    first = only_first(driven_scene(published_set(3)))
    disc = DiscBody("disc", "planet 1", 0.01, Inertia(0.5, 1e-3, 1e-3))
    bare, copied = (with_planets(replace(first, discs=d), "planet 1", 3) for d in ((), (disc,)))
    assert [part.shaft for part in copied.discs] == ["planet 1", "planet 1 2", "planet 1 3"]
    added = [b.inertia.mass - a.inertia.mass for a, b in zip(*map(rotors, (bare, copied)), strict=True)]
    np.testing.assert_allclose(sorted(added), [0.0] * (len(added) - 3) + [0.5] * 3, atol=1e-12)


def rotors(scene):
    return assemble(scene).rotors


def placed(scene, mesh):
    """Where a mesh is and which way it drives."""
    gears = [scene.gear(name) for name in (mesh.driver, mesh.driven)]
    shafts = [next(s for s in scene.shafts if s.name == gear.shaft) for gear in gears]
    return tuple(
        (gear.internal, *np.round(shaft.origin, 9)) for gear, shaft in zip(gears, shafts, strict=True)
    )


def test_planets_meet_one_after_the_other_as_tooth_numbers_say():
    """27 + 99 teeth, three planets: sun and ring in phase (both divisible by 3); 28 + 100, four: in phase."""
    positions = assemble(driven_scene(published_set(3))).arrays.reference.offset % 1.0
    np.testing.assert_allclose(np.minimum(positions, 1.0 - positions), 0.0, atol=1e-9)
    gears = published_set(4, teeth=(30, 36, 102))  # 30 = 4 * 7 + 2: neighbors half a pitch apart
    sun = assemble(driven_scene(gears)).arrays.reference.offset[::2] % 1.0
    np.testing.assert_allclose(sun, [0.0, 0.5, 0.0, 0.5], atol=1e-9)


def test_ring_phase_of_even_and_odd_planets():
    assert ring_phase(36) == pytest.approx(0.5)
    assert ring_phase(35) % 1.0 == pytest.approx(0.0)
    thick = ring_phase(35, (math.pi / 70 + 1e-3, math.pi / 70 + 1e-3))
    assert thick == pytest.approx(2e-3 * 35 / (2 * math.pi))
    mirrored = ring_phase(35, (math.pi / 70 + 1e-3,) * 2, driver="ring")
    assert (thick + mirrored) % 1.0 == pytest.approx(0.0, abs=1e-12)


def test_planets_that_do_not_fit_are_refused():
    one = only_first(driven_scene(published_set(3)))
    with pytest.raises(InputError, match=r"number = 'planet 2, off by -?0\.5 teeth'"):
        with_planets(one, "planet 1", 4)
    with pytest.raises(InputError, match="angles"):
        with_planets(one, "planet 1", 3, [0.1, 2.0, 4.0])
    with pytest.raises(InputError, match="off its axis"):
        with_planets(one, "sun", 3)


def test_pin_errors_go_to_their_planets():
    one = only_first(planetary_scene(published_set(3)))
    bearings = with_planets(one, "planet 1", 3, None, [(0.0, 1e-6), (2e-6, 0.0), (0.0, 0.0)]).planet_bearings
    assert [(b.radial_error, b.tangential_error) for b in bearings] == [(0.0, 1e-6), (2e-6, 0.0), (0.0, 0.0)]
