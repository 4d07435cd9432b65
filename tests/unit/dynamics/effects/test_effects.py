"""Only the freedoms a scene calls for, with reasons; choices are obeyed."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from geared_scenes import gear_pair_scene, with_bushings, with_gear
from planetary_scenes import BEARING_STIFFNESS, PRESSURE_ANGLE, driven_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.effects import EFFECTS, LEFT_OUT, RotorEffect
from dynamics.errors import InputError
from dynamics.loads import AppliedForce
from dynamics.shafts import Inertia


def kinds(scene, shaft="output"):
    names = assemble(scene).freedoms.name
    return [name.split(".")[1] for name in names if name.startswith(f"{shaft}.")]


def test_a_centered_spur_pair_moves_across_and_turns():
    assert kinds(gear_pair_scene()) == ["x", "y", "rotation"]
    assert kinds(gear_pair_scene(), "input") == ["x", "y"]  # its rotation is imposed


def test_a_gear_off_the_middle_tilts_its_shaft_only():
    scene = gear_pair_scene()
    shaft = replace(scene.shafts[1], origin=(0.08, 0.0, 0.01))
    scene = with_gear(replace(scene, shafts=(scene.shafts[0], shaft)), 1, position=0.09)
    assert kinds(scene) == ["x", "y", "tilt_x", "tilt_y", "rotation"]
    assert kinds(scene, "input") == ["x", "y"]
    massless = with_gear(scene, 1, inertia=Inertia())  # the center of mass stays in the middle
    entries = assemble(massless).ledger.entries
    reasons = {entry.part: (entry.on, entry.reason) for entry in entries if entry.effect == "tilt"}
    assert reasons["output"] == (True, "a mesh is off the supports' center")
    assert not reasons["input"][0]


def test_a_helical_pair_moves_along_and_tilts():
    scene = with_gear(with_gear(gear_pair_scene(), 0, base_helix_angle=0.2), 1, base_helix_angle=-0.2)
    assert kinds(scene) == ["x", "y", "z", "tilt_x", "tilt_y", "rotation"]


def test_a_force_along_the_axis_moves_its_shaft_along():
    held = with_bushings(gear_pair_scene(), axial_stiffness=1e8)
    assert kinds(held) == ["x", "y", "rotation"]
    pushed = replace(held, forces=(AppliedForce("thrust", "output", 0.1, (0.0, 0.0, 70.0)),))
    assert kinds(pushed) == ["x", "y", "z", "rotation"]
    assert kinds(pushed, "input") == ["x", "y"]
    across = replace(held, forces=(AppliedForce("belt", "output", 0.1, (70.0, 0.0, 0.0)),))
    assert kinds(across) == ["x", "y", "rotation"]


def test_without_bushings_a_shaft_only_turns():
    scene = replace(gear_pair_scene(effects={"lateral": "on"}), bushings=())
    assert kinds(scene) == ["rotation"]
    reasons = {entry.reason for entry in assemble(scene).ledger.entries}
    assert "no bushing with radial stiffness: held rigidly" in reasons


def test_forces_around_a_sun_cancel_and_push_a_planet_along():
    """Sun and ring push a planet the same way, 2 F cos(alpha_w); around the sun three forces cancel."""
    entries = assemble(driven_scene(published_set(3))).ledger.entries
    influence = {entry.part: entry.influence for entry in entries if entry.effect == "lateral"}
    force = 3779.2895  # of every mesh
    for planet in ("planet 1", "planet 2", "planet 3"):
        exact = 2.0 * force * math.cos(PRESSURE_ANGLE) / BEARING_STIFFNESS
        assert influence[planet] == pytest.approx(exact, rel=1e-6, abs=0.0)
    for central in ("sun", "ring", "carrier"):
        assert influence[central] < 1e-9 * force / BEARING_STIFFNESS
        assert next(e for e in entries if (e.effect, e.part) == ("lateral", central)).on


def test_choices_are_obeyed_and_their_price_is_stated():
    off = assemble(gear_pair_scene(effects={"lateral": "off"}))
    assert off.freedoms.name == ("output.rotation",)
    entry = next(e for e in off.ledger.entries if e.effect == "lateral")
    assert not entry.on
    assert entry.choice == "off"
    assert entry.influence == pytest.approx(2660.44 / 2e8, rel=1e-4)  # static deflection it leaves out
    assert kinds(gear_pair_scene(effects={"tilt": "on", "axial": "on"})) == [
        "x",
        "y",
        "z",
        "tilt_x",
        "tilt_y",
        "rotation",
    ]


@pytest.mark.parametrize("effects", [{"weather": "on"}, {"tilt": "yes"}])
def test_unknown_effects_and_choices_are_refused(effects):
    with pytest.raises(InputError, match="effects"):
        assemble(gear_pair_scene(effects=effects))


def test_the_ledger_speaks_of_every_effect_shaft_and_mesh_and_of_what_is_left_out():
    ledger = assemble(gear_pair_scene()).ledger
    assert {(e.effect, e.part) for e in ledger.entries} == {
        (f.name, part)
        for f in EFFECTS
        for part in (("input", "output") if isinstance(f, RotorEffect) else ("mesh",))
    }
    assert all(e.reason for e in ledger.entries)
    assert ledger.to_json()["left_out"] == LEFT_OUT


def test_default_damping_makes_the_bouncing_shaft_have_its_ratio():
    system = assemble(with_bushings(gear_pair_scene(), damping_ratio=0.07))
    arrays = system.arrays
    x = system.freedoms.name.index("output.x")
    mass, damping, stiffness = (m[x, x] for m in (arrays.mass, arrays.damping, arrays.stiffness))
    assert damping / (2.0 * (stiffness * mass) ** 0.5) == pytest.approx(0.07)


def test_given_damping_is_used():
    system = assemble(with_bushings(gear_pair_scene(), radial_damping=123.0))
    x = system.freedoms.name.index("input.y")
    assert system.arrays.damping[x, x] == pytest.approx(246.0)
