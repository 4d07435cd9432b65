"""Base pitches that the printing of radii sets apart are made one, and said; wider ones are refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, gear_pair_scene, with_gear

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import modal_analysis
from dynamics.scene import Scene
from dynamics.simulation import simulate


def printed(ratio: float) -> Scene:
    """A wheel of 40 teeth whose base radius is off by `ratio`."""
    scene = with_gear(
        gear_pair_scene(duration=0.005), 1, teeth=40, base_radius=2.0 * BASE_RADIUS * (1.0 + ratio)
    )
    shafts = (scene.shafts[0], replace(scene.shafts[1], origin=(0.12, 0.0, 0.0)))
    return replace(scene, shafts=shafts)


@pytest.mark.parametrize("ratio", [5e-4, -8e-4, 1e-7])
def test_radii_as_printed_run_and_the_correction_is_stated(ratio: float) -> None:
    scene = printed(ratio)
    system = assemble(scene)
    pinion, wheel = system.scene.gears
    assert wheel.base_pitch == pytest.approx(pinion.base_pitch, rel=1e-14)
    # least squares of 20 and 40 teeth: a fifth of the difference stays with the wheel, four with the pinion
    assert wheel.base_radius / scene.gears[1].base_radius - 1.0 == pytest.approx(-0.2 * ratio, rel=2e-3)
    assert pinion.base_radius / BASE_RADIUS - 1.0 == pytest.approx(0.8 * ratio, rel=2e-3)
    run = simulate(scene)
    for said in (run.receipt, modal_analysis(system).facts):
        stated = said["base_radius_corrected"]
        assert stated[wheel.name] == {"given": scene.gears[1].base_radius, "used": wheel.base_radius}
        assert set(stated) == {pinion.name, wheel.name}


def test_pitches_that_agree_stay_as_they_are_bit_by_bit() -> None:
    for ratio in (0.0, 1e-15):
        scene = printed(ratio)
        system = assemble(scene)
        assert system.scene is scene
        assert system.corrections == {}
    assert "base_radius_corrected" not in simulate(printed(0.0)).receipt


def test_wider_differences_are_refused() -> None:
    for ratio in (1.1e-3, -2e-3):
        with pytest.raises(
            InputError, match=r"must agree to 0\.001; smaller differences are corrected"
        ) as caught:
            assemble(printed(ratio))
        assert caught.value.field == "meshes[0].driven"


def test_a_train_gets_one_pitch() -> None:
    """Two meshes in a row: a gear between two others is corrected once, by all three."""
    scene = printed(6e-4)
    third = replace(scene.gears[0], name="third", base_radius=BASE_RADIUS * (1.0 - 3e-4))
    shaft = replace(scene.shafts[0], name="third", origin=(0.24, 0.0, 0.0))
    gears = (*scene.gears, replace(third, shaft="third"))
    mesh = replace(
        scene.meshes[0], name="second", driver=scene.gears[1].name, driven="third", nominal_force=1.0
    )
    moved = tuple(replace(b, name=f"{b.name} 3", shaft="third") for b in scene.bushings if b.shaft == "input")
    whole = replace(
        scene,
        shafts=(*scene.shafts, shaft),
        gears=gears,
        meshes=(replace(scene.meshes[0], nominal_force=1.0), mesh),
        bushings=(*scene.bushings, *moved),
    )
    pitches = [gear.base_pitch for gear in assemble(whole).scene.gears]
    np.testing.assert_allclose(pitches, pitches[0], rtol=1e-14)
