"""Estimated influence of effects, and the decision by a tolerance."""

import json
from dataclasses import replace

import numpy as np
import pytest
from flexible_scenes import flexible_pair
from geared_scenes import RPM, gear_pair_scene, spring_table, with_gear

from dynamics import FreeRotation, Housing, Outputs, RollingContact, Scene, TimeLaw, ablate, simulate
from dynamics.errors import InputError
from dynamics.influence import decide_effects, estimate_influences, neglected_check
from dynamics.influence.linear_figures import linear_figures
from dynamics.influence.operating_conditions import operating_conditions
from dynamics.loads import AppliedForce, Orders
from dynamics.shafts import BeamSection

QUICK = Outputs(energy_audit=False, receipt="minimal")
SERIES = ("dynamic_transmission_error", "mesh_force", "bearing_force", "drive_torque")


def helical(**changes: object) -> Scene:
    """A slightly helical pair at speed, axially soft: axial motion has little influence, tilt much."""
    scene = gear_pair_scene(
        duration=0.1, outputs=QUICK, on_violation="report", speed=TimeLaw.constant(2000.0 * RPM), **changes
    )
    scene = with_gear(with_gear(scene, 0, base_helix_angle=0.02), 1, base_helix_angle=-0.02)
    return replace(scene, bushings=tuple(replace(part, axial_stiffness=1e8) for part in scene.bushings))


def test_estimates_are_right_within_a_factor_of_two():
    scene = helical()
    made = ablate(scene, only=["lateral", "axial", "tilt"])
    seen = 0
    for entry in made.effects:
        for estimated, measured, size in (
            (entry.estimate.mean, entry.mean_change, entry.with_effect.mean),
            (entry.estimate.peak_to_peak, entry.peak_to_peak_change, entry.with_effect.peak_to_peak),
        ):
            if max(abs(estimated[0]), abs(measured[0])) > 0.01 * size[0]:
                assert 0.5 < estimated[0] / measured[0] < 2.0, entry.name
                seen += 1
    assert seen >= 1
    lateral = next(one for one in made.effects if one.name == "lateral")
    assert (lateral.estimate.freedoms, lateral.estimate.on) == (4, True)
    json.dumps([entry.estimate.to_json() for entry in made.effects if entry.estimate], allow_nan=False)


def test_an_effect_that_changes_no_force_is_not_solved_for(monkeypatch):
    """Lateral motion alone does not turn with the shafts: gyroscopic terms are none, and known to be 0."""
    looked: list[str] = []

    def figures(system, conditions):
        looked.append(" ".join(name for name, choice in system.scene.effects.items() if choice != "auto"))
        return linear_figures(system, conditions)

    monkeypatch.setattr(neglected_check, "linear_figures", figures)
    scene = gear_pair_scene(duration=0.1, outputs=QUICK, speed=TimeLaw.constant(2000.0 * RPM))
    found = estimate_influences(scene)
    assert found["gyroscopic"].largest == 0.0 and "gyroscopic" not in looked
    assert found["lateral"].largest > 0.0 and "lateral" in looked


def in_housing(speed: TimeLaw, duration: float = 0.1, inert: float = 6.75, **changes: object) -> Scene:
    """A pair on four seats of 6.75 kg on springs, tied to each other: modes from 1061 to 1369 Hz."""
    tie = 4.0 * np.eye(4) - np.ones((4, 4))
    stiffness, mass = np.kron(3e8 * np.eye(4) + 5e7 * tie, np.eye(3)), inert * np.eye(12)
    settings = {"outputs": QUICK, "on_violation": "report"} | changes
    scene = gear_pair_scene(duration=duration, speed=speed, **settings)
    names = tuple(part.name for part in scene.bushings)
    housing = Housing("case", names, stiffness.tolist(), mass=mass.tolist(), damping_ratio=0.03)
    return replace(scene, housings=(housing,))


@pytest.mark.parametrize("rpm", [3000.0, 4000.0])
def test_a_housing_is_estimated_as_ablation_shows_it(rpm):
    scene = in_housing(TimeLaw.constant(rpm * RPM))
    (entry,) = ablate(scene, only=["housing_modes"]).effects
    assert entry.on and entry.estimate is not None
    assert (entry.estimate.freedoms, entry.estimate.rows) == (12, 12)
    assert abs(entry.peak_to_peak_change[0]) > 0.02 * entry.with_effect.peak_to_peak[0]
    assert entry.estimate.peak_to_peak[0] == pytest.approx(entry.peak_to_peak_change[0], rel=0.1)
    assert entry.estimate.mean[0] == pytest.approx(entry.mean_change[0], rel=0.1)
    changed, estimated = entry.bearing_order_change, entry.estimate.bearing_orders
    np.testing.assert_allclose(estimated, changed, rtol=0.05, atol=2e-3 * np.max(np.abs(changed)))
    with_effect = np.max(entry.with_effect.bearing_orders, axis=0)
    relative = np.max(np.abs(changed), axis=0) / with_effect
    np.testing.assert_allclose(entry.estimate.relative_bearing_orders, relative, rtol=0.07)
    assert relative[0] > 2.0  # the order that the housing's inertia holds down
    size = np.max(entry.with_effect.orders)
    np.testing.assert_allclose(entry.estimate.orders, entry.order_change, rtol=0.05, atol=2e-3 * size)
    assert entry.estimate.text.startswith(f"{entry.level.text}, ")
    assert entry.level_change.order == entry.level.order == 1.0
    assert entry.level.decibels == pytest.approx(entry.level_change.decibels, abs=0.3)
    json.dumps(entry.estimate.to_json(), allow_nan=False)
    assert np.all(np.isfinite(entry.order_change)) and np.all(np.isfinite(entry.mean_change))


@pytest.mark.law
def test_along_a_run_up_the_largest_of_each_order_is_estimated():
    """Order 1 passes the modes and others come from above: sign and size within a factor of 1.6."""
    scene = in_housing(TimeLaw((0.0, 1.0), (2000.0 * RPM, 5000.0 * RPM)), duration=1.0)
    (entry,) = ablate(scene, only=["housing_modes"]).effects
    changed, estimated = entry.bearing_order_change[0], entry.estimate.bearing_orders[0]
    assert np.min(np.abs(changed) / entry.with_effect.bearing_orders[0]) > 0.1
    assert np.all((estimated / changed > 1.0 / 1.6) & (estimated / changed < 1.6))


def shaken(order: float, **changes: object) -> Scene:
    """The pair in its housing, on a mesh without ripple, shaken by a wave of an order of its shaft."""
    course = Orders("input", (order,), (1.0,), (0.0,))
    shake = AppliedForce("shake", "input", 0.1, (0.0, 200.0, 0.0), course=course)
    spring = gear_pair_scene(spring_table(4e8)).meshes
    return replace(in_housing(TimeLaw.constant(3000.0 * RPM)), meshes=spring, forces=(shake,), **changes)


def test_what_loads_shake_is_estimated_as_ablation_shows_it():
    """Order 20 of the shaft, which is the mesh's first: at 1000 Hz, below the modes of the housing."""
    (entry,) = ablate(shaken(20.0), only=["housing_modes"]).effects
    changed = entry.bearing_order_change[:, 0]
    assert np.max(np.abs(changed)) > 0.1 * np.max(entry.with_effect.bearing_orders)
    np.testing.assert_allclose(
        entry.estimate.bearing_orders[:, 0], changed, rtol=0.05, atol=0.01 * np.max(np.abs(changed))
    )


def test_an_effect_that_only_loads_call_for_is_not_neglected_for_a_tolerance():
    """Order 21 is none of the mesh; linear theory sees its share of the bearing forces."""
    scene = shaken(21.0, tolerance=0.1)
    influence = estimate_influences(scene)["housing_modes"]
    assert np.max(np.abs(influence.bearing_orders)) < 1e-6 * np.max(np.abs(influence.bearing_force))
    assert influence.relative_bearing_force > 0.1
    decision = decide_effects(scene)
    assert decision.scene.effects.get("housing_modes", "auto") == "auto"


@pytest.mark.parametrize(("rpm", "reach"), [(300.0, 0.095), (1000.0, 0.095), (3000.0, 0.095)])
def test_what_the_scene_does_not_call_for_changes_no_run_by_a_percent(rpm, reach):
    """Ten mesh orders just below a tenth of the first mode: the ledger leaves the effect off."""
    first = 10.0 * 20.0 * rpm / 60.0 / reach
    scene = in_housing(TimeLaw.constant(rpm * RPM), inert=3e8 / (2.0 * np.pi * first) ** 2)
    (entry,) = ablate(scene, only=["housing_modes"]).effects
    assert not entry.on and entry.estimate is not None
    assert entry.estimate.largest < 0.01
    for change, size in (
        (entry.peak_to_peak_change, entry.with_effect.peak_to_peak),
        (entry.order_change, np.max(entry.with_effect.orders)),
        (entry.bearing_order_change, np.max(entry.with_effect.bearing_orders)),
    ):
        assert np.max(np.abs(change)) < 0.01 * np.max(size)


def test_an_effect_without_which_nothing_holds_has_no_estimate():
    """Shafts that only tilt do not reach the clearance of their bearings: nothing resists them."""
    scene = replace(gear_pair_scene(spring_table(4e8)), effects={"tilt": "on", "lateral": "on"})
    bushings = tuple(replace(part, radial_stiffness=0.0) for part in scene.bushings)
    contacts = tuple(RollingContact(part.name, 1e11, 1.5, 1e-5) for part in bushings)
    found = estimate_influences(replace(scene, bushings=bushings, rolling_contacts=contacts))
    assert "lateral" not in found
    assert "clearance" in found["tilt"].beyond
    assert found["tilt"].text.endswith(found["tilt"].beyond)
    linear = estimate_influences(helical())
    assert not any(size.beyond for size in linear.values())
    assert all(size.level.order <= 10.0 for size in linear.values())


def test_conditions_pass_all_speeds_of_the_run():
    """Also those before the first moment that is looked at, and after the last."""
    law = TimeLaw((0.0, 0.1), (10.0, 200.0))
    scene = in_housing(law)
    (condition,) = operating_conditions(scene, 0)
    ends = scene.references[0].speed(np.array([0.0, scene.duration]))
    np.testing.assert_allclose(condition.span, ends)
    assert condition.passing(condition.span * [1.001, 0.999]).speed.size == condition.speed.size + 2


def test_a_tolerance_leaves_off_what_cannot_be_seen_and_says_so():
    scene = helical()
    influences = estimate_influences(scene)
    assert 1e-6 < influences["axial"].largest < 0.01 < influences["lateral"].largest
    loose = min(0.5, 11.0 * influences["axial"].largest)
    decision = decide_effects(replace(scene, tolerance=loose))
    assert decision.scene.effects.get("axial") == "off"
    assert decision.scene.effects.get("lateral", "auto") == "auto"
    tight = decide_effects(replace(scene, tolerance=9.0 * influences["axial"].largest))
    assert "axial" not in tight.automatic
    run, off = simulate(replace(scene, tolerance=loose)), simulate(replace(scene, effects={"axial": "off"}))
    for name in SERIES:
        np.testing.assert_array_equal(getattr(run, name), getattr(off, name))
    entries = [one for one in run.effect_ledger["entries"] if one["effect"] == "axial"]
    for entry in entries:
        assert (entry["on"], entry["choice"], entry["called_for"], entry["price"]) == (
            False,
            "auto",
            True,
            "",
        )
        assert entry["reason"].startswith(f"neglected for the tolerance of {loose:g}: influence ")
    assert run.effect_ledger["influences"]["axial"]["relative_mean"] == influences["axial"].relative_mean
    assert run.case["tolerance"] == loose


def test_without_a_tolerance_the_scene_decides_and_an_explicit_choice_is_obeyed():
    scene = helical()
    assert decide_effects(scene).scene is scene
    changed = replace(scene, tolerance=0.5, effects={"axial": "on"})
    assert decide_effects(changed).scene.effects["axial"] == "on"
    price = simulate(replace(scene, tolerance=0.001, effects={"tilt": "off"})).effect_ledger
    entry = next(one for one in price["entries"] if one["effect"] == "tilt")
    assert entry["price"] == f"left out: {price['influences']['tilt']['words']}"
    for wrong in (0.0, 0.6, -1.0):
        with pytest.raises(InputError, match="tolerance"):
            replace(scene, tolerance=wrong)


def test_a_tolerance_switches_on_what_the_scene_does_not_call_for_but_can_be_seen():
    thick = BeamSection(0.2, 0.12)
    stiff = flexible_pair(
        thick, gear=0.02, speed=TimeLaw.constant(2000.0 * RPM), duration=0.02, outputs=QUICK
    )
    stiff = replace(stiff, effects={})
    (plain, tight) = (simulate(replace(stiff, tolerance=tol)) for tol in (None, 1e-4))
    for run, on in ((plain, False), (tight, True)):
        entries = [one for one in run.effect_ledger["entries"] if one["effect"] == "flexible_shafts"]
        assert {one["on"] for one in entries} == {on}
    assert entries[0]["reason"].startswith("on for the tolerance of 0.0001: influence")


def test_moments_are_those_of_the_run():
    up = gear_pair_scene(speed=TimeLaw((0.0, 1.0), (0.0, 100.0)), duration=1.0)
    (condition,) = operating_conditions(up, 0, 0.5)
    assert 50.0 < condition.speed[0] < condition.speed[-1] < 100.0
    np.testing.assert_allclose(condition.rate, 100.0, rtol=1e-9)
    assert np.sum(condition.weight) == pytest.approx(1.0, rel=1e-12)
    seen = condition.passing(np.array([10.0, 70.0]))
    assert seen.speed.size == condition.speed.size + 1
    assert 70.0 in seen.speed
    assert seen.weight[seen.speed == 70.0] == 0.0
    falling = replace(up.loads[0], torque=TimeLaw((0.0, 1.0), (100.0, 20.0)))
    parts = operating_conditions(replace(up, loads=(falling,)), 0)
    assert len(parts) == 6
    assert [part.time for part in parts] == sorted(part.time for part in parts)


def test_once_at_rest_a_run_passes_no_operating_condition():
    halted = gear_pair_scene(speed=TimeLaw((0.0, 0.5, 1.0), (100.0, 0.0, 0.0)), duration=1.0)
    assert operating_conditions(halted, 0) and operating_conditions(halted, 0, 0.6) == ()


def test_where_linear_theory_says_nothing_there_is_no_estimate():
    scene = gear_pair_scene(spring_table(4e8), duration=0.01)
    free = replace(scene, drives=(), loads=(), free_rotations=(FreeRotation("free", "input", 10.0),))
    assert estimate_influences(free) == {}
    assert decide_effects(replace(free, tolerance=0.1)).automatic == {}
