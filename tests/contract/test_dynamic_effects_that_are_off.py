"""An effect of the multibody model that is off is one that is not there, bit by bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, with_gear, with_mesh

from dynamics.assembly import assemble
from dynamics.effects import EFFECTS
from dynamics.influence import decide_effects, estimate_influences
from dynamics.loads import TimeLaw
from dynamics.meshes import CoastFlank
from dynamics.scene import Scene
from dynamics.simulation import simulate

RPM = np.pi / 30.0
SERIES = ("dynamic_transmission_error", "mesh_force", "coast_force", "bearing_force", "drive_torque")


def everything() -> Scene:
    """A helical pair at speed with a coast flank: lateral, axial, tilting, spinning, parting."""
    scene = gear_pair_scene(
        spring_table(4e8, 20e-6), speed=TimeLaw.constant(30000.0 * RPM), torque=5.0, duration=0.004
    )
    scene = with_gear(with_gear(scene, 0, base_helix_angle=0.3), 1, base_helix_angle=-0.3)
    bushings = tuple(replace(bushing, axial_stiffness=1e8) for bushing in scene.bushings)
    scene = replace(scene, bushings=bushings, on_violation="report")
    return with_mesh(scene, coast=CoastFlank(backlash=10e-6, thickness=0.48))


@pytest.mark.law
@pytest.mark.parametrize("name", [effect.name for effect in EFFECTS])
def test_a_run_with_an_effect_off_is_that_of_a_build_without_it(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = everything()
    off = simulate(replace(scene, effects={name: "off"}))
    remaining = tuple(effect for effect in EFFECTS if effect.name != name)
    monkeypatch.setattr(assemble, "EFFECTS", remaining)
    without = simulate(scene)
    assert name not in {entry["effect"] for entry in without.effect_ledger["entries"]}
    assert off.freedom == without.freedom
    for series in (
        "dynamic_transmission_error",
        "mesh_force",
        "coast_force",
        "bearing_force",
        "drive_torque",
    ):
        np.testing.assert_array_equal(getattr(off, series), getattr(without, series), err_msg=series)
    assert off.statistics == without.statistics


def test_a_run_with_an_effect_neglected_for_a_tolerance_is_that_of_a_build_without_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = everything()
    scene = replace(whole, drives=(replace(whole.drives[0], speed=TimeLaw.constant(40.0 * RPM)),))
    decided = decide_effects(replace(scene, tolerance=0.05))
    assert "gyroscopic" in estimate_influences(scene)
    off = simulate(replace(scene, tolerance=0.05))
    left = {entry["effect"] for entry in off.effect_ledger["entries"] if not entry["on"]}
    assert set(decided.neglected) <= left
    assert "gyroscopic" in left
    remaining = tuple(effect for effect in EFFECTS if effect.name not in left)
    monkeypatch.setattr(assemble, "EFFECTS", remaining)
    without = simulate(scene)
    for series in SERIES:
        np.testing.assert_array_equal(getattr(off, series), getattr(without, series), err_msg=series)
    assert off.statistics == without.statistics


def test_the_scene_has_most_effects_on() -> None:
    entries = simulate(everything()).effect_ledger["entries"]
    on = {entry["effect"] for entry in entries if entry["on"]}
    assert on >= {"lateral", "axial", "tilt", "gyroscopic", "backlash"}
