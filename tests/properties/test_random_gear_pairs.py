"""Laws of geometry over random feasible gears and pairs."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry import Gear, GearPair, corner_contact, tooth_profile

RACKS = st.fixed_dictionaries(
    {
        "normal_module": st.floats(2e-4, 4e-2),
        "normal_pressure_angle": st.floats(0.25, 0.44),
        "helix_angle": st.sampled_from([0.0]) | st.floats(0.002, 0.7),
        "addendum_coefficient": st.floats(0.7, 1.2),
        "dedendum_coefficient": st.floats(1.1, 1.5),
        "root_radius_coefficient": st.floats(0.0, 0.45),
    }
)
TEETH = st.integers(6, 200)
SHIFTS = st.floats(-0.6, 1.0)


def build(teeth: int, shift: float, rack: dict[str, float], **more: Any) -> Gear:
    """Make the gear, or skip the example if there is none."""
    module = rack["normal_module"]
    fields = {"face_width": 6.0 * module, "bore_diameter": 0.2 * module, "profile_shift_coefficient": shift}
    try:
        return Gear(teeth=teeth, **(rack | fields | more))
    except InfeasibleGeometry:
        assume(False)
        raise


@st.composite
def gears(draw: st.DrawFn) -> Gear:
    return build(draw(TEETH), draw(SHIFTS), draw(RACKS))


@st.composite
def pairs(draw: st.DrawFn) -> GearPair:
    rack = draw(RACKS)
    first = build(draw(TEETH), draw(SHIFTS), rack)
    second = build(draw(TEETH), draw(SHIFTS), rack | {"helix_angle": -rack["helix_angle"]})
    try:
        tight = GearPair(first, second)
        return replace(
            tight, center_distance=tight.center_distance + draw(st.floats(0.0, 0.1)) * rack["normal_module"]
        )
    except InfeasibleGeometry:
        assume(False)
        raise


@given(gears())
def test_profile_is_one_continuous_curve_of_unit_speed(gear: Gear) -> None:
    profile = tooth_profile(gear)
    assert profile.s_space <= profile.s_root < profile.s_form < profile.s_tip
    unit = gear.normal_module
    for joint in (profile.s_root, profile.s_form):
        jump = profile.flank(joint + 1e-9 * unit) - profile.flank(joint - 1e-9 * unit)
        assert np.hypot(*jump) < 3e-9 * unit
    for low, high in ((profile.s_root, profile.s_form), (profile.s_form, profile.s_tip)):
        s = np.linspace(low, high, 1001)
        assert np.sum(np.hypot(*np.diff(profile.flank(s), axis=0).T)) == pytest.approx(high - low, rel=1e-3)


@given(gears())
def test_normals_are_unit_everywhere_and_smooth_at_the_form_point_unless_undercut(gear: Gear) -> None:
    profile = tooth_profile(gear)
    normals = profile.normal(np.linspace(profile.s_space, profile.s_tip, 200))
    assert np.hypot(*normals.T) == pytest.approx(np.ones(200), rel=1e-13)
    turn = profile.normal(profile.s_form + 1e-12 * gear.normal_module) - profile.normal(profile.s_form)
    assert np.hypot(*turn) < 1e-4
    if not gear.form_point.undercut and gear.root_radius_coefficient > 0.05:
        kink = profile.normal(profile.s_form - 1e-12 * gear.normal_module) - profile.normal(profile.s_form)
        assert np.hypot(*kink) < 1e-4


@given(gears())
def test_tooth_has_material_and_space_at_every_radius(gear: Gear) -> None:
    profile = tooth_profile(gear)
    x, y = profile.flank(np.linspace(profile.s_space, profile.s_tip, 300)).T
    angle, radius = np.arctan2(x, y), np.hypot(x, y)
    assert np.all(angle > 0.0)
    assert np.all(angle <= np.pi / gear.teeth * (1.0 + 1e-12))
    assert np.min(radius) == pytest.approx(gear.root_radius, rel=1e-12)
    assert np.max(radius) == pytest.approx(gear.tip_radius, rel=1e-12)


@given(pairs())
def test_feasible_pair_keeps_contact_on_the_involutes(pair: GearPair) -> None:
    path = pair.path_of_contact
    assert pair.total_contact_ratio >= 1.0
    assert path.start >= pair.pinion.form_roll_length * (1.0 - 1e-9)
    assert pair.common_tangent - path.end >= pair.wheel.form_roll_length * (1.0 - 1e-9)
    assert pair.transverse_base_backlash >= -1e-6 * pair.pinion.normal_module


@given(pairs())
def test_swapping_and_mirroring_change_nothing_that_matters(pair: GearPair) -> None:
    swapped = pair.swapped()
    mirrored = GearPair(
        replace(pair.pinion, helix_angle=-pair.pinion.helix_angle),
        replace(pair.wheel, helix_angle=-pair.wheel.helix_angle),
        pair.center_distance,
    )
    for other in (swapped, mirrored):
        for name in ("transverse_contact_ratio", "overlap_ratio", "common_tangent", "working_pressure_angle"):
            assert getattr(other, name) == pytest.approx(getattr(pair, name), rel=1e-12)
    assert mirrored.path_of_contact == pair.path_of_contact


@given(pairs(), st.floats(0.05, 20.0))
def test_lengths_scale(pair: GearPair, scale: float) -> None:
    def scaled(gear: Gear) -> Gear:
        lengths = {
            name: getattr(gear, name) * scale for name in ("normal_module", "face_width", "bore_diameter")
        }
        return replace(gear, **lengths)

    large = GearPair(scaled(pair.pinion), scaled(pair.wheel), pair.center_distance * scale)
    assert large.transverse_contact_ratio == pytest.approx(pair.transverse_contact_ratio, rel=1e-9)
    module = pair.pinion.normal_module
    assert np.array(large.path_of_contact.points) == pytest.approx(
        scale * np.array(pair.path_of_contact.points), rel=1e-9, abs=1e-9 * scale * module
    )
    backlash = scale * pair.transverse_base_backlash
    assert large.transverse_base_backlash == pytest.approx(backlash, rel=1e-6, abs=1e-11 * scale * module)


@given(pairs(), st.sampled_from(["approach", "exit"]), st.floats(1e-6, 2.0))
def test_corner_gap_is_never_negative_and_starts_from_contact(
    pair: GearPair, side: Any, reach: float
) -> None:
    over = np.linspace(0.0, reach * pair.pinion.normal_module, 25)
    state = corner_contact(pair, side, over)
    assert state.valid[0]
    assert state.gap[0] == pytest.approx(0.0, abs=1e-12 * pair.center_distance)
    gap, arms = state.gap[state.valid], (state.lever_arm_ratio_pinion, state.lever_arm_ratio_wheel)
    assert np.all(np.diff(gap) >= -1e-13 * pair.center_distance)
    assert np.all(state.slope_angle[state.valid] >= 0.0)
    for arm in arms:
        assert np.all((arm[state.valid] > 0.0) & (arm[state.valid] <= 1.0 + 1e-12))
