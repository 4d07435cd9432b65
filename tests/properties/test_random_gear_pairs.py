"""Laws of geometry over random feasible gears and pairs, and over ring gears and the pinions inside them."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry import Gear, GearPair, InternalGearPair, RingGear, corner_contact, tooth_profile
from fe_contact.involute import involute_function
from fe_contact.types import FloatArray

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
def test_profile_is_one_continuous_curve_of_unit_speed(gear):
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
def test_normals_are_unit_everywhere_and_smooth_at_the_form_point_unless_undercut(gear):
    profile = tooth_profile(gear)
    normals = profile.normal(np.linspace(profile.s_space, profile.s_tip, 200))
    assert np.hypot(*normals.T) == pytest.approx(np.ones(200), rel=1e-13)
    turn = profile.normal(profile.s_form + 1e-12 * gear.normal_module) - profile.normal(profile.s_form)
    assert np.hypot(*turn) < 1e-4
    if not gear.form_point.undercut and gear.root_radius_coefficient > 0.05:
        kink = profile.normal(profile.s_form - 1e-12 * gear.normal_module) - profile.normal(profile.s_form)
        assert np.hypot(*kink) < 1e-4


@given(gears())
def test_tooth_has_material_and_space_at_every_radius(gear):
    profile = tooth_profile(gear)
    x, y = profile.flank(np.linspace(profile.s_space, profile.s_tip, 300)).T
    angle, radius = np.arctan2(x, y), np.hypot(x, y)
    assert np.all(angle > 0.0)
    assert np.all(angle <= np.pi / gear.teeth * (1.0 + 1e-12))
    assert np.min(radius) == pytest.approx(gear.root_radius, rel=1e-12)
    assert np.max(radius) == pytest.approx(gear.tip_radius, rel=1e-12)


@given(pairs())
def test_feasible_pair_keeps_contact_on_the_involutes(pair):
    path = pair.path_of_contact
    assert pair.total_contact_ratio >= 1.0
    assert path.start >= pair.pinion.form_roll_length * (1.0 - 1e-9)
    assert pair.common_tangent - path.end >= pair.wheel.form_roll_length * (1.0 - 1e-9)
    assert pair.transverse_base_backlash >= -1e-6 * pair.pinion.normal_module


@given(pairs())
def test_swapping_and_mirroring_change_nothing_that_matters(pair):
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
def test_lengths_scale(pair, scale):
    def scaled(gear):
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
def test_corner_gap_is_never_negative_and_starts_from_contact(pair, side, reach):
    over = np.linspace(0.0, reach * pair.pinion.normal_module, 25)
    state = corner_contact(pair, side, over)
    assert state.valid[0]
    assert state.gap[0] == pytest.approx(0.0, abs=1e-12 * pair.center_distance)
    gap, arms = state.gap[state.valid], (state.lever_arm_ratio_pinion, state.lever_arm_ratio_wheel)
    assert np.all(np.diff(gap) >= -1e-13 * pair.center_distance)
    assert np.all(state.slope_angle[state.valid] >= 0.0)
    for arm in arms:
        assert np.all((arm[state.valid] > 0.0) & (arm[state.valid] <= 1.0 + 1e-12))


RING_RACKS = st.fixed_dictionaries(
    {
        "normal_module": st.floats(2e-4, 4e-2),
        "normal_pressure_angle": st.floats(0.25, 0.44),
        "helix_angle": st.sampled_from([0.0]) | st.floats(-0.6, 0.6),
    }
)
RING_TEETH = st.integers(40, 300)
RING_SHIFTS = st.floats(-1.0, 0.3)
ROUNDINGS = st.floats(0.0, 0.25)


def build_ring(
    teeth: int, shift: float, rounding: float, height: float, rack: dict[str, float], **more: Any
) -> RingGear:
    """Make the ring gear, or skip the example if there is none."""
    module = rack["normal_module"]
    fields = {
        "face_width": 6.0 * module,
        "rim_diameter": 2.5 * teeth * module,
        "profile_shift_coefficient": shift,
        "addendum_coefficient": height,
        "root_radius_coefficient": rounding,
    }
    try:
        return RingGear(teeth=teeth, **(rack | fields | more))
    except InfeasibleGeometry:
        assume(False)
        raise


@st.composite
def rings(draw: st.DrawFn) -> RingGear:
    height = draw(st.floats(0.5, 1.0))
    more = {"cutter_teeth": draw(st.integers(18, 35))}
    return build_ring(draw(RING_TEETH), draw(RING_SHIFTS), draw(ROUNDINGS), height, draw(RING_RACKS), **more)


@st.composite
def internal_pairs(draw: st.DrawFn) -> InternalGearPair:
    rack, height = draw(RING_RACKS), draw(st.floats(0.5, 0.85))
    wheel = build_ring(draw(RING_TEETH), draw(RING_SHIFTS), draw(ROUNDINGS), height, rack)
    module, teeth = rack["normal_module"], draw(st.integers(16, wheel.teeth - 1))
    fields = {"face_width": 6.0 * module, "bore_diameter": 0.2 * module}
    fields["profile_shift_coefficient"] = draw(st.floats(-0.2, 0.8))
    try:
        pinion = Gear(teeth=teeth, addendum_coefficient=draw(st.floats(0.6, 1.0)), **(rack | fields))
        tight = InternalGearPair(pinion, wheel)
        return replace(tight, center_distance=tight.center_distance - draw(st.floats(0.0, 0.05)) * module)
    except InfeasibleGeometry:
        assume(False)
        raise


@given(rings())
def test_profile_of_a_ring_is_one_continuous_curve_of_unit_speed(gear):
    profile, unit = tooth_profile(gear), gear.normal_module
    assert profile.s_space <= profile.s_root < profile.s_form < profile.s_tip < 0.0
    for joint in (profile.s_root, profile.s_form):
        jump = profile.flank(joint + 1e-9 * unit) - profile.flank(joint - 1e-9 * unit)
        assert np.hypot(*jump) < 3e-9 * unit
        if gear.root_radius_coefficient > 0.05:
            kink = profile.normal(joint + 1e-12 * unit) - profile.normal(joint - 1e-12 * unit)
            assert np.hypot(*kink) < 1e-4
    for low, high in ((profile.s_root, profile.s_form), (profile.s_form, profile.s_tip)):
        s = np.linspace(low, high, 1001)
        assert np.sum(np.hypot(*np.diff(profile.flank(s), axis=0).T)) == pytest.approx(high - low, rel=1e-3)


@given(rings())
def test_tooth_of_a_ring_has_material_and_space_at_every_radius(gear):
    profile = tooth_profile(gear)
    s = np.linspace(profile.s_space, profile.s_tip, 300)
    x, y = profile.flank(s).T
    angle, radius = np.arctan2(x, y), np.hypot(x, y)
    assert np.all(angle > 0.0)
    assert np.all(angle <= math.pi / gear.teeth * (1.0 + 1e-12))
    assert np.all(np.diff(radius) <= 1e-12 * radius[1:])
    assert radius[0] == pytest.approx(gear.root_radius, rel=1e-12)
    assert radius[-1] == pytest.approx(gear.tip_radius, rel=1e-12)
    assert np.hypot(*profile.normal(s).T) == pytest.approx(np.ones(300), rel=1e-13)


@given(internal_pairs())
def test_feasible_internal_pair_keeps_contact_on_the_involutes(pair):
    path, module = pair.path_of_contact, pair.pinion.normal_module
    assert pair.total_contact_ratio >= 1.0
    assert path.start >= pair.pinion.form_roll_length * (1.0 - 1e-9)
    assert pair.common_tangent + path.end <= pair.wheel.form_roll_length * (1.0 + 1e-9)
    assert pair.transverse_base_backlash >= -1e-6 * module
    assert min(pair.tip_clearances) > 0.0
    # the hollow flank is the flatter one, so that they touch from outside
    assert np.all(pair.relative_curvature(np.linspace(path.start, path.end, 9)[1:]) > 0.0)


@given(internal_pairs(), st.floats(-0.5, 0.5))
def test_outlines_of_a_feasible_pair_never_overlap(pair, phase):
    first, second = polar_flank(pair.pinion), polar_flank(pair.wheel)
    working = involute_function(pair.working_pressure_angle)
    turn = 2.0 * math.pi * phase / pair.pinion.teeth
    center_1 = turn - pair.pinion.base_thickness_half_angle + working
    center_2 = turn / pair.speed_ratio + pair.wheel.base_thickness_half_angle + working
    a, slack = pair.center_distance, 1e-4 * pair.pinion.normal_module
    assert deepest(first, pair.pinion.teeth, center_1, a, second, pair.wheel.teeth, center_2) < slack
    assert deepest(second, pair.wheel.teeth, center_2, -a, first, pair.pinion.teeth, center_1) < slack


def polar_flank(gear: Gear | RingGear) -> FloatArray:
    """Polar angle and radius (2, n) of a tooth's right flank, rising in radius."""
    profile = tooth_profile(gear)
    x, y = profile.flank(np.linspace(profile.s_root, profile.s_tip, 1501)).T
    polar = np.stack((np.arctan2(x, y), np.hypot(x, y)))
    return polar[:, np.argsort(polar[1])]


def deepest(
    mover: FloatArray,
    teeth: int,
    center: float,
    height: float,
    fixed: FloatArray,
    fixed_teeth: int,
    zero: float,
) -> float:
    """Largest arc by which a flank point of the mover, its center at `height`, is inside the other gear."""
    sparse = mover[:, ::10]
    angle = (
        np.concatenate((sparse[0], -sparse[0])) + center + 2.0 * math.pi / teeth * np.arange(teeth)[:, None]
    )
    radius = np.tile(sparse[1], 2)
    x, y = radius * np.sin(angle), height + radius * np.cos(angle)
    distance, pitch = np.hypot(x, y), 2.0 * math.pi / fixed_teeth
    beside = np.abs((np.arctan2(x, y) - zero + 0.5 * pitch) % pitch - 0.5 * pitch)
    depth = distance * (np.interp(distance, fixed[1], fixed[0]) - beside)
    within = (distance >= fixed[1, 0]) & (distance <= fixed[1, -1])
    return float(np.max(depth, where=within, initial=-np.inf))


@given(internal_pairs(), st.floats(0.05, 20.0))
def test_lengths_scale_and_hands_mirror(pair, scale):
    def scaled(gear, size):
        lengths = {name: getattr(gear, name) * scale for name in ("normal_module", "face_width", size)}
        return replace(gear, helix_angle=-gear.helix_angle, **lengths)

    first, second = scaled(pair.pinion, "bore_diameter"), scaled(pair.wheel, "rim_diameter")
    other = InternalGearPair(first, second, pair.center_distance * scale)
    unit = scale * pair.pinion.normal_module
    assert other.transverse_contact_ratio == pytest.approx(pair.transverse_contact_ratio, rel=1e-9)
    assert np.array(other.path_of_contact.points) == pytest.approx(
        scale * np.array(pair.path_of_contact.points), rel=1e-9, abs=1e-9 * unit
    )
    backlash = scale * pair.transverse_base_backlash
    assert other.transverse_base_backlash == pytest.approx(backlash, rel=1e-6, abs=1e-10 * unit)
