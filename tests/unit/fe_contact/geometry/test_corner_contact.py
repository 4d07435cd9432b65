"""Corner contact and sliding, against rates of the gap and velocities of rigid bodies."""

import importlib
import math
from typing import Any

import numpy as np
import pytest
from spur_gears import PAIR, make_gear

from fe_contact import GearPair, InternalGearPair, RingGear
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes, Side, corner_contact, sliding_factor, specific_sliding

SIDES: tuple[Side, Side] = ("approach", "exit")
sides = pytest.mark.parametrize("side", SIDES)


@pytest.fixture
def pair():
    return GearPair(make_gear(teeth=17, profile_shift_coefficient=0.3), make_gear(teeth=43))


@sides
def test_gap_and_slope_grow_from_the_path_until_the_edge_leaves_the_flank(pair, side):
    start = corner_contact(pair, side, 0.0)
    on_path = (
        pair.path_of_contact.start if side == "approach" else pair.common_tangent - pair.path_of_contact.end
    )
    assert start.valid
    assert start.gap == pytest.approx(0.0, abs=1e-17)
    assert start.slope_angle == pytest.approx(0.0, abs=1e-14)
    assert start.flank_roll_length == pytest.approx(on_path, rel=1e-12)
    assert start.lever_arm_ratio_pinion == pytest.approx(1.0, rel=1e-14)
    assert start.lever_arm_ratio_wheel == pytest.approx(1.0, rel=1e-14)
    state = corner_contact(pair, side, np.linspace(0.0, 3e-3, 200))
    assert np.all(state.valid)
    assert np.all(np.diff(state.gap) > 0.0)
    assert np.all(np.diff(state.slope_angle) > 0.0)
    gap = corner_contact(pair, side, np.array([1e-5, 2e-5])).gap
    assert gap[1] / gap[0] == pytest.approx(4.0, rel=1e-2)
    assert corner_contact(pair, side, 1e-4).gap.shape == ()
    assert corner_contact(pair, side, np.full((2, 3), 1e-4)).gap.shape == (2, 3)
    over = np.linspace(0.0, 0.05, 300)
    state = corner_contact(pair, side, over)
    assert state.valid[0]
    assert not state.valid[-1]
    assert np.count_nonzero(np.diff(state.valid.astype(int))) == 1  # valid up to a limit, then never again
    for part in (state.gap, state.flank_roll_length, state.slope_angle, state.lever_arm_ratio_pinion):
        assert np.array_equal(np.isnan(part), ~state.valid)
    flank = pair.pinion if side == "approach" else pair.wheel
    inside = state.flank_roll_length[state.valid]
    assert np.all((inside >= flank.form_roll_length) & (inside <= flank.tip_roll_length))


def test_lever_arms_are_rates_of_the_gap(pair):
    over, step = np.linspace(1e-4, 6e-3, 20), 1e-7
    rate = (corner_contact(pair, "exit", over + step).gap - corner_contact(pair, "exit", over - step).gap) / (
        2.0 * step
    )
    state = corner_contact(pair, "exit", over)
    assert 1.0 - rate == pytest.approx(state.lever_arm_ratio_pinion, rel=1e-8)
    assert np.all(state.lever_arm_ratio_wheel == 1.0)
    over, step = np.linspace(1e-4, 3e-3, 20), 1e-7
    rate = (
        corner_contact(pair, "approach", over + step).gap - corner_contact(pair, "approach", over - step).gap
    ) / (2.0 * step)
    state = corner_contact(pair, "approach", over)
    assert 1.0 / (1.0 + rate) == pytest.approx(state.lever_arm_ratio_wheel, rel=1e-8)
    assert np.all(state.lever_arm_ratio_pinion == 1.0)


def test_swapping_the_gears_swaps_the_sides_to_first_order(pair):
    # the driving gear is held in both cases, so they differ by the gap itself over the overshoot only
    over = np.array([1e-6, 1e-5])
    exit_gap, approach_gap = (
        corner_contact(pair, "exit", over).gap,
        corner_contact(pair.swapped(), "approach", over).gap,
    )
    assert approach_gap == pytest.approx(exit_gap, rel=1e-2)
    # exactly: a lag e of the tip gear is an overshoot larger by e
    assert corner_contact(pair, "exit", over + approach_gap).gap == pytest.approx(approach_gap, rel=1e-9)


@sides
def test_lengths_scale(side):
    large: dict[str, Any] = {"normal_module": 12e-3}
    one = GearPair(make_gear(teeth=25), make_gear(teeth=31))
    three = GearPair(make_gear(teeth=25, **large), make_gear(teeth=31, **large))
    over = np.linspace(0.0, 3e-3, 9)
    assert corner_contact(three, side, 3.0 * over).gap == pytest.approx(
        3.0 * corner_contact(one, side, over).gap, rel=1e-9, abs=1e-16
    )


def test_bad_arguments_are_refused(pair):
    for overshoot in (-1e-9, np.nan):
        with pytest.raises(InputError, match="overshoot"):
            corner_contact(pair, "exit", overshoot)
    with pytest.raises(InputError, match="side"):
        corner_contact(pair, "middle", 0.0)


def test_newton_ends_where_rounding_begins(pair, monkeypatch):
    """Requested less than the rounding of a gap it would go to and fro in the last bits to its limit."""
    module = importlib.import_module("fe_contact.geometry.corner_contact")
    calls, touch = [], module._touch
    monkeypatch.setattr(module, "_touch", lambda *given: calls.append(0) or touch(*given))
    over = np.linspace(0.0, 0.3, 200) * pair.base_pitch
    gap = corner_contact(pair, "approach", over).gap
    assert len(calls) <= 8
    alone = [corner_contact(pair, "approach", one).gap for one in over]
    assert np.array_equal(gap, alone)  # no bit depends on what is asked beside it
    calls.clear()
    monkeypatch.setattr(module, "_ROUNDING", 0.0)
    assert gap == pytest.approx(corner_contact(pair, "approach", over).gap, rel=1e-12, abs=1e-16)
    assert len(calls) == 50


def external_pair() -> ParallelAxes:
    return GearPair(make_gear(teeth=23, profile_shift_coefficient=0.3), make_gear(teeth=47))


def internal_pair() -> ParallelAxes:
    module = make_gear(teeth=36).normal_module
    ring = RingGear(96, module, 0.02, rim_diameter=110 * module, addendum_coefficient=0.9)
    return InternalGearPair(make_gear(teeth=36), ring)


def tangential_speeds(pair: ParallelAxes, roll: float) -> tuple[float, float]:
    """Speed of either flank across the line of action at 1 rad/s of the pinion, from omega x r."""
    alpha = pair.working_pressure_angle
    along, across = (math.cos(alpha), math.sin(alpha)), (math.sin(alpha), -math.cos(alpha))
    foot = pair.pinion.base_radius * np.array([-math.sin(alpha), math.cos(alpha)])
    touch = foot + roll * np.array(along)
    centers = np.array([0.0, 0.0]), np.array([0.0, pair.wheel.sign * pair.center_distance])
    omegas = -1.0, pair.wheel.sign / pair.speed_ratio  # the pinion drives clockwise
    speeds = []
    for center, omega in zip(centers, omegas, strict=True):
        arm = touch - center
        speeds.append(float(np.dot(omega * np.array([-arm[1], arm[0]]), across)))
    return speeds[0], speeds[1]


@pytest.mark.parametrize("make_pair", [external_pair, internal_pair])
def test_sliding_is_the_difference_of_the_flanks_velocities(make_pair):
    pair = make_pair()
    for roll in pair.path_of_contact.points:
        first, second = tangential_speeds(pair, roll)
        pitch_line = pair.operating_pitch_radii[0]
        assert sliding_factor(pair, roll) == pytest.approx((first - second) / pitch_line, abs=1e-12)
        assert specific_sliding(pair, roll) == pytest.approx(
            ((first - second) / first, (second - first) / second), abs=1e-12
        )


def test_sliding_changes_its_sense_at_the_pitch_point():
    pair = external_pair()
    a, _, c, _, e = (float(sliding_factor(pair, roll)) for roll in pair.path_of_contact.points)
    assert a < 0.0 < e
    assert c == pytest.approx(0.0, abs=1e-14)


def test_specific_sliding_of_equal_spur_gears_by_hand():
    """20/20, module 4: at A the roll lengths are sqrt(37.8548^2 - 37.5877^2) = 4.489 and 22.873 mm."""
    pair = PAIR
    first, second = specific_sliding(pair, pair.path_of_contact.start)
    assert float(first) == pytest.approx(1.0 - 22.873 / 4.489, abs=2e-3)
    assert float(second) == pytest.approx(1.0 - 4.489 / 22.873, abs=2e-4)


@pytest.mark.parametrize("make_pair", [external_pair, internal_pair])
def test_tips_clear_the_mating_roots_by_dedendum_less_addendum(make_pair):
    pair = make_pair()
    low, high = pair.tip_clearances
    nearest = pair.center_distance if not pair.internal else -pair.center_distance
    assert low == pytest.approx(nearest - pair.wheel.sign * pair.wheel.root_radius - pair.pinion.tip_radius)
    assert high == pytest.approx(nearest - pair.wheel.sign * pair.wheel.tip_radius - pair.pinion.root_radius)
    assert min(low, high) > 0.1 * pair.pinion.normal_module
