"""Sizes of effects that decide by a tolerance of levels, are kept by content, and are screened."""

from dataclasses import replace

import numpy as np
import pytest
from flexible_scenes import flexible_pair
from geared_scenes import RPM, gear_pair_scene, square_wave_table, with_gear
from planetary_scenes import driven_scene, published_set

from dynamics import Integration, Outputs, Scene, TimeLaw, ablate, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.influence import decide_effects, estimate_influences, neglected_check
from dynamics.influence.content_key import content_key
from dynamics.linearize import partial_fractions
from dynamics.linearize.parametric_response import parametric_response
from dynamics.linearize.steady_vibration import excited
from dynamics.shafts import BeamSection
from dynamics.simulation import to_file

QUICK = Outputs(energy_audit=False, receipt="minimal")


def helical(rpm: float = 2000.0, **changes: object) -> Scene:
    """A slightly helical pair whose axial motion is called for and changes little."""
    scene = gear_pair_scene(
        duration=0.1, outputs=QUICK, on_violation="report", speed=TimeLaw.constant(rpm * RPM), **changes
    )
    scene = with_gear(with_gear(scene, 0, base_helix_angle=0.02), 1, base_helix_angle=-0.02)
    return replace(scene, bushings=tuple(replace(part, axial_stiffness=1e8) for part in scene.bushings))


def test_effects_called_for_are_neglected_up_to_half_of_the_tolerance_together():
    scene = helical()
    sizes = estimate_influences(scene)
    axial = sizes["axial"].decibels
    assert sizes["axial"].on and 1e-4 < axial < 0.1 < sizes["lateral"].decibels
    loose = decide_effects(replace(scene, level_tolerance=2.1 * axial))
    assert loose.scene.effects == {"axial": "off"}
    assert loose.automatic["axial"].startswith(
        f"neglected for the tolerance of {2.1 * axial:g} dB: influence "
    )
    tight = decide_effects(replace(scene, level_tolerance=1.9 * axial))
    assert "axial" not in tight.scene.effects
    run = simulate(replace(scene, level_tolerance=2.1 * axial))
    off = simulate(replace(scene, effects={"axial": "off"}))
    np.testing.assert_array_equal(run.mesh_force, off.mesh_force)
    check = next(row for row in run.effect_ledger["checks"] if row["effect"] == "axial")
    assert check["holds"] and run.case["level_tolerance"] == 2.1 * axial


def test_an_effect_that_no_rule_calls_for_is_on_beyond_the_tolerance_alone():
    """Thick shafts yield less than the rule asks for, and are seen."""
    speed, thick = TimeLaw.constant(2000.0 * RPM), BeamSection(0.2, 0.12)
    scene = replace(flexible_pair(thick, gear=0.02, speed=speed, duration=0.02, outputs=QUICK), effects={})
    size = estimate_influences(scene)["flexible_shafts"]
    assert not size.on and size.decibels > 0.01
    for tolerance, choice in ((0.9 * size.decibels, "on"), (1.1 * size.decibels, None)):
        decision = decide_effects(replace(scene, level_tolerance=tolerance))
        assert decision.scene.effects.get("flexible_shafts") == choice


def test_where_flanks_part_nothing_is_neglected_by_a_level():
    scene = helical(14400.0)  # mesh order 1 meets the mode of the mesh
    sizes = estimate_influences(scene)
    assert sizes["axial"].parts and sizes["axial"].beyond.startswith("flanks part")
    assert "off" not in decide_effects(replace(scene, level_tolerance=3.0)).scene.effects.values()


def test_a_relative_tolerance_comes_first_and_bounds_are_named():
    scene = helical(tolerance=1e-6)
    assert "off" not in decide_effects(replace(scene, level_tolerance=3.0)).scene.effects.values()
    for wrong in (0.0, 3.5, -1.0):
        with pytest.raises(InputError, match="level_tolerance"):
            replace(scene, level_tolerance=wrong)


def test_sizes_are_computed_once_for_one_content(monkeypatch):
    """Copies of equal content share them, also with other steps; whatever counts makes another key."""
    scene, count = helical(), [0]
    computed = neglected_check.linear_figures

    def counted(*parts):
        count[0] += 1
        return computed(*parts)

    monkeypatch.setattr(neglected_check, "_KNOWN", {})
    monkeypatch.setattr(neglected_check, "linear_figures", counted)
    first, before = estimate_influences(scene), count[0]
    assert before > 0
    again = estimate_influences(replace(helical(), integration=Integration(tolerance=1e-8)))
    assert count[0] == before and again["axial"].level == first["axial"].level
    estimate_influences(helical(2001.0))
    assert count[0] > before


def test_a_minimal_receipt_has_sizes_of_what_is_decided_alone():
    """And decides alike: effects that the scene chooses take no estimate."""
    lean = helical(level_tolerance=0.1, effects={"tilt": "off"})
    full = replace(lean, outputs=Outputs(energy_audit=False))
    few, all_sizes, again = (decide_effects(scene) for scene in (lean, full, lean))
    assert set(again.influences) == set(few.influences)
    assert set(all_sizes.influences) - set(few.influences) == {"tilt"}
    assert few.scene.effects == all_sizes.scene.effects


def test_an_ablation_decides_once_for_the_scene_itself(monkeypatch):
    """Toggled scenes decide nothing anew: each differs from the scene by one effect."""
    decision: list[float | None] = []

    def recorded(scene):
        decision.append(scene.level_tolerance)
        return decide_effects(scene)

    monkeypatch.setattr(to_file, "decide_effects", recorded)
    found = ablate(helical(level_tolerance=0.1), only=["axial", "lateral"])
    assert {entry.name: entry.on for entry in found.effects} == {"axial": False, "lateral": True}
    assert decision and set(decision) == {None}


def test_every_field_that_sizes_read_is_part_of_the_key():
    scene = helical()
    table = scene.meshes[0].table
    deflection = np.array(table.deflection)
    deflection.flat[3] *= 1.0 + 1e-12
    others = [
        replace(scene, duration=0.11),
        replace(scene, effects={"tilt": "on"}),
        replace(scene, tolerance=0.1),
        replace(scene, outputs=replace(QUICK, mesh_orders=11)),
        replace(scene, bushings=scene.bushings[::-1]),
        replace(scene, meshes=(replace(scene.meshes[0], table=replace(table, deflection=deflection)),)),
    ]
    keys = [content_key(part) for part in (scene, *others)]
    assert len(set(keys)) == len(keys) and None not in keys
    assert content_key(replace(scene, on_violation="fail")) == keys[0]


class Unknown:
    """A quantity whose content nobody knows."""

    name, unit = "anything", "dB"

    def squares(self, forces: object) -> np.ndarray:
        return np.asarray(0.5 * np.sum(np.abs(forces.bearing_force[:, :3]) ** 2, axis=(0, 1)))


def test_what_has_no_known_content_is_not_kept():
    assert content_key(replace(helical(), quantity=Unknown())) is None


def test_screened_sizes_are_those_of_stiffness_that_varies(monkeypatch):
    """Within the hundredth of a decibel below which the mean stiffness tells them."""
    scene = driven_scene(published_set(3), speed=TimeLaw.constant(60.0))
    scene = replace(
        scene, meshes=tuple(replace(mesh, table=square_wave_table()) for mesh in scene.meshes), duration=0.05
    )
    found = []
    for minimum in (3, 1000):
        monkeypatch.setattr(neglected_check, "SCREENED", minimum)
        monkeypatch.setattr(neglected_check, "_KNOWN", {})
        found.append(estimate_influences(scene))
    screened, whole = found
    assert set(screened) == set(whole) and len(whole) >= 2
    small = [name for name, size in whole.items() if size.decibels < 0.01]
    assert small
    for name, size in whole.items():
        assert screened[name].level.decibels == pytest.approx(size.level.decibels, abs=0.01)
        if name not in small:
            np.testing.assert_array_equal(screened[name].peak_to_peak, size.peak_to_peak)
    assert len(small) < len(whole)


def test_partial_fractions_are_the_factorized_response(monkeypatch):
    system = assemble(flexible_pair(table=square_wave_table(), duration=0.01))
    assert len(system.arrays.mass) >= partial_fractions.MIN
    at, found = excited(system, 0.0, 6), []
    speed, rate = np.linspace(50.0, 900.0, 9), np.full(9, 5.0)
    for minimum in (partial_fractions.MIN, 10_000):
        monkeypatch.setattr(partial_fractions, "MIN", minimum)
        found.append(parametric_response(at, speed, rate, 6)[0])
    size = np.max(np.abs(found[1].bearing_force))
    np.testing.assert_allclose(found[0].bearing_force, found[1].bearing_force, rtol=0.0, atol=1e-9 * size)
    assert not np.array_equal(found[0].bearing_force, found[1].bearing_force)


def test_the_system_of_the_estimates_is_run_where_nothing_is_decided_otherwise():
    scene = helical()
    sizes = estimate_influences(scene)
    neglected_check.forget_sizes()
    loose = decide_effects(replace(scene, level_tolerance=2.1 * sizes["axial"].decibels))
    assert loose.assembled is not None and loose.automatic
    alone = assemble(loose.scene)
    assert loose.system().freedoms.name == alone.freedoms.name != loose.assembled[1].freedoms.name
    choices = dict.fromkeys(sizes, "off") | {"axial": "on", "lateral": "on"}
    chosen = replace(scene, effects=choices, level_tolerance=0.1)
    decision = decide_effects(chosen)
    assert decision.scene is chosen and decision.assembled is not None
    assert decision.system() is decision.assembled[1]
    assert np.array_equal(decision.system().arrays.mass, assemble(chosen).arrays.mass)
    other = replace(decision, scene=replace(chosen, effects={"axial": "off"}))
    assert other.system().freedoms.name == alone.freedoms.name
