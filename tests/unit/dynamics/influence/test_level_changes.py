"""Sizes of effects in dB: of nothing 0, and what runs with and without them show."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, with_gear

from dynamics import Outputs, Scene, TimeLaw, ablate, forced_response
from dynamics.acoustics import a_weighting
from dynamics.assembly.assemble import assemble
from dynamics.influence import decide_effects, estimate_influences, neglected_check, response_influences
from dynamics.influence.level_change import MAX, BearingForces, level_change
from dynamics.influence.linear_figures import linear_figures
from dynamics.influence.operating_conditions import conditions_at

LINES = {1.0: 4.0, 2.0: 9.0, 3.0: 1e-9}


@dataclass(frozen=True)
class OnBearing:
    bearing: str
    name: str = "force on one bearing"
    unit: str = "dB(A)"

    def squares(self, forces):
        own = forces.bearing_force[forces.bearing.index(self.bearing), 0]
        return 10.0 ** (a_weighting(forces.frequency) / 10.0) * np.abs(own) ** 2


def helical(rpm: float = 2000.0, **changes: object) -> Scene:
    """A slightly helical pair at speed: tilt changes bearing forces most."""
    scene = gear_pair_scene(
        duration=0.1,
        outputs=Outputs(energy_audit=False, receipt="minimal"),
        on_violation="report",
        speed=TimeLaw.constant(rpm * RPM),
        **changes,
    )
    scene = with_gear(with_gear(scene, 0, base_helix_angle=0.2), 1, base_helix_angle=-0.2)
    return replace(scene, bushings=tuple(replace(part, axial_stiffness=1e8) for part in scene.bushings))


@pytest.mark.law
def test_what_changes_nothing_is_0_db():
    for lines in (LINES, {}, {1.0: 0.0}):
        change = level_change(lines, lines, "force", "dB")
        assert (change.decibels, change.relative) == (0.0, 0.0)
        assert change.text == "0 dB of force"
    nothing = helical(effects={"friction": "on"})
    assert "friction" not in estimate_influences(nothing)


@pytest.mark.law
def test_levels_follow_amplitudes():
    """The order with the largest change of amplitude counts; with and without change places."""
    change = level_change(LINES, {1.0: 4.0, 2.0: 36.0, 3.0: 1e-3}, "force", "dB(A)")
    assert (change.order, change.relative) == (2.0, 1.0)
    assert change.decibels == pytest.approx(20.0 * math.log10(2.0))
    assert change.text == "+6 dB(A) of force at order 2"
    back = level_change({1.0: 4.0, 2.0: 36.0}, LINES, "force")
    assert back.decibels == pytest.approx(-change.decibels)
    gone = level_change(LINES, {}, "force")
    assert gone.decibels == -MAX and gone.relative == 1.0
    assert gone.text == "more than -60 dB of force at order 2"


@pytest.mark.law
@pytest.mark.parametrize("quantity", [None, OnBearing("input.left")], ids=["all", "one bearing"])
def test_runs_with_and_without_an_effect_differ_by_what_the_ledger_says(quantity):
    scene = replace(helical(), quantity=quantity)
    ablation = ablate(scene, only=["axial", "tilt", "gyroscopic"])
    seen = 0
    for entry in ablation.effects:
        stated, computed = entry.level, entry.level_change
        assert (
            stated.order == entry.estimate.level.order
        )  # at constant speed the second half is all of the run
        assert stated.decibels == pytest.approx(entry.estimate.level.decibels, abs=1e-9)
        assert stated.quantity == (scene.quantity or BearingForces()).name
        assert max(map(abs, (stated.decibels, computed.decibels))) < 0.1 or (
            0.5 < stated.decibels / computed.decibels < 2.0
        ), entry.name
        seen += abs(computed.decibels) > 0.1
    assert seen >= 2


def test_a_response_is_sized_at_its_speeds():
    """As a run at that speed is, and not as at another one."""
    scene = helical()
    slow, fast = (
        response_influences(scene, np.array([rpm * RPM]))["lateral"].level for rpm in (20.0, 2000.0)
    )
    run = estimate_influences(scene)["lateral"].level
    assert fast.order == run.order
    assert fast.decibels == pytest.approx(run.decibels, abs=0.1)
    assert abs(slow.decibels - fast.decibels) > 1.0
    (condition,) = conditions_at(np.linspace(10.0, 500.0, 200), 0.0)
    assert condition.speed.size == 32
    assert (condition.speed[0], condition.speed[-1]) == (10.0, 500.0)


@pytest.mark.law
def test_a_response_costs_its_lines_and_the_systems_without_an_effect(monkeypatch):
    """Each system at 32 speeds at most; those that an effect leaves as they are are not solved."""
    system, speed = assemble(helical()), np.linspace(10.0, 500.0, 200)
    solved: list[int] = []

    def counted(own, conditions):
        solved.append(sum(condition.speed.size for condition in conditions))
        return linear_figures(own, conditions)

    monkeypatch.setattr(neglected_check, "linear_figures", counted)
    response_influences(helical(), speed)
    cost = neglected_check.response_cost(system, speed, 6)
    assert len(solved) <= cost.systems < 2 * len(solved)
    fewer = neglected_check.response_cost(system, speed[: solved[0]], 3)
    assert fewer.system == cost.system
    assert neglected_check.response_cost(system, speed[:5], 3).system < cost.system
    many, few = (forced_response(system, speed, orders).order.size for orders in (6, 3))
    assert many > few
    lines = [each.speed - neglected_check._VARYING for each in (cost, fewer)]
    assert lines[0] / lines[1] == pytest.approx(many / few)


def test_the_quantity_of_a_scene_decides_its_effects():
    """What is small in it is neglected, what is large is not."""
    scene = helical(tolerance=0.5)
    sizes = estimate_influences(scene)
    assert decide_effects(scene).scene.effects.get("tilt", "auto") == "auto"
    heard = replace(scene, quantity=OnBearing(scene.bushings[0].name))
    own = estimate_influences(heard)
    for name, influence in own.items():
        assert influence.largest == influence.level.relative
        assert sizes[name].largest == max(
            sizes[name].relative_mean, sizes[name].relative_peak_to_peak, sizes[name].relative_bearing_force
        )
        assert influence.level.quantity in influence.text
    loose = replace(heard, tolerance=min(0.5, 11.0 * own["axial"].level.relative))
    assert decide_effects(loose).scene.effects.get("axial") == "off"
    tight = replace(heard, tolerance=9.0 * own["axial"].level.relative)
    assert decide_effects(tight).scene.effects.get("axial", "auto") == "auto"
