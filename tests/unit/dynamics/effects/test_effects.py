"""Only the freedoms a scene calls for, with reasons; choices are obeyed."""

import math
from dataclasses import replace
from functools import partial

import pytest
from geared_scenes import gear_pair_scene, spring_table, with_bushings, with_gear
from planetary_scenes import BEARING_STIFFNESS, PRESSURE_ANGLE, driven_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.effects import EFFECTS, NEGLECTED, RotorEffect
from dynamics.effects.ledger import mechanism_of
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.loads import AppliedForce
from dynamics.shafts import Inertia


def test_scenes_that_differ_by_their_outputs_share_a_mechanism():
    scene = gear_pair_scene()
    lean = replace(scene, outputs=replace(scene.outputs, energy_audit=False))
    whole, other = mechanism_of(scene), mechanism_of(lean)
    assert other.rotors is whole.rotors and other.scene.outputs is lean.outputs
    assert whole.scene.outputs is scene.outputs
    longer = replace(scene, duration=2.0 * scene.duration)
    assert mechanism_of(longer).scene.duration == longer.duration


def kinds(scene, shaft="output"):
    names = assemble(scene).freedoms.name
    return [name.split(".")[1] for name in names if name.startswith(f"{shaft}.")]


def pushed(**changes):
    """A pair whose bearings hold across alone, and a force along the output."""
    force = AppliedForce("push", "output", 0.1, (0.0, 0.0, 50.0))
    return replace(with_bushings(gear_pair_scene(), axial_stiffness=0.0), forces=(force,), **changes)


def double_helical(stiffness, **changes):
    """Two halves of opposite hand on each shaft; the input's bearings hold it by that stiffness along it."""
    scene = gear_pair_scene()
    gears = tuple(
        replace(gear, name=gear.name + half, position=z, base_helix_angle=hand * own)
        for gear, own in zip(scene.gears, (0.4, -0.4), strict=True)
        for half, z, hand in ((" left", 0.07, 1.0), (" right", 0.13, -1.0))
    )
    meshes = tuple(
        replace(
            scene.meshes[0], name=half, driver="pinion" + half, driven="wheel" + half, nominal_force=1300.0
        )
        for half in (" left", " right")
    )
    bushings = tuple(
        replace(part, axial_stiffness=stiffness if part.shaft == "input" else 1e8) for part in scene.bushings
    )
    return replace(scene, gears=gears, meshes=meshes, bushings=bushings, **changes)


@pytest.mark.parametrize(
    ("scene", "field", "words"),
    [
        (pushed, "forces[0].force.z", "nothing holds along its axis"),
        (partial(double_helical, 0.0), "gears[0]", "double helical, without axial support"),
    ],
)
def test_what_moves_along_an_axis_is_not_held_in_silence(scene, field, words):
    with pytest.raises(InputError) as caught:
        assemble(scene())
    assert caught.value.field == field and words in str(caught.value)
    assert "axial stiffness" in str(caught.value) and '"off"' in str(caught.value)
    assemble(scene(effects={"axial": "off"}))


def test_a_double_helical_shaft_that_may_float_shares_the_load_of_unlike_halves():
    """A mesh that is early on the left: the shaft moves along until both halves carry as much."""

    def share(stiffness):
        scene = double_helical(stiffness, effects={"axial": "on"})
        early = replace(scene.meshes[0], table=spring_table(4e8, level=1.0))
        late = replace(scene.meshes[1], table=spring_table(2e8, level=1.0))
        system = assemble(replace(scene, meshes=(early, late)))
        force = static_equilibrium(system).mesh_force
        return float(force[0] / force[1])

    assert share(1.0) == pytest.approx(1.0, abs=1e-6)
    assert share(1e9) > 1.02


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
    assert ledger.to_json()["left_out"] == NEGLECTED


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
