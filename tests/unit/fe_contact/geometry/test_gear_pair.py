from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest

from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.geometry import Gear, GearPair


def helical_pair(make_gear: Callable[..., Gear], **fields: float) -> GearPair:
    pinion = make_gear(teeth=23, helix_angle=0.3, profile_shift_coefficient=0.3, **fields)
    return GearPair(pinion, make_gear(teeth=47, helix_angle=-0.3, profile_shift_coefficient=0.1, **fields))


def test_contact_ratio_is_the_textbook_sum(make_gear: Callable[..., Gear]) -> None:
    pair = helical_pair(make_gear)
    first, second = pair.pinion, pair.wheel
    tips = math.sqrt(first.tip_radius**2 - first.base_radius**2)
    tips += math.sqrt(second.tip_radius**2 - second.base_radius**2)
    length = tips - pair.center_distance * math.sin(pair.working_pressure_angle)
    assert pair.transverse_contact_ratio == pytest.approx(length / pair.base_pitch, rel=1e-14)
    overlap = 25e-3 * math.tan(0.3) / (math.pi * first.transverse_module)
    assert pair.overlap_ratio == pytest.approx(overlap, rel=1e-14)
    assert pair.total_contact_ratio == pair.transverse_contact_ratio + pair.overlap_ratio


def test_points_of_the_path_of_contact(make_gear: Callable[..., Gear]) -> None:
    pair = helical_pair(make_gear)
    start, inner, pitch, outer, end = pair.path_of_contact.points
    assert end == pair.pinion.tip_roll_length
    assert pair.common_tangent - start == pytest.approx(pair.wheel.tip_roll_length, rel=1e-14)
    assert end - inner == pytest.approx(pair.base_pitch, rel=1e-14)
    assert outer - start == pytest.approx(pair.base_pitch, rel=1e-14)
    assert math.hypot(pair.pinion.base_radius, pitch) == pytest.approx(
        pair.operating_pitch_radii[0], rel=1e-14
    )
    assert start < inner < outer < end


def test_position_zero_is_the_pitch_point_and_one_position_is_one_base_pitch(
    make_gear: Callable[..., Gear],
) -> None:
    pair = helical_pair(make_gear)
    first, second = pair.roll_lengths(np.array([0.0, 0.25, 0.0]), np.array([0, 0, 1]))
    assert first[0] == pair.path_of_contact.pitch_point
    assert first[1] - first[0] == pytest.approx(0.25 * pair.base_pitch, rel=1e-12)
    assert first[2] - first[0] == pytest.approx(pair.base_pitch, rel=1e-12)  # pair +1 is ahead
    assert first + second == pytest.approx(np.full(3, pair.common_tangent), rel=1e-15)
    assert pair.position(first) == pytest.approx([0.0, 0.25, 1.0], abs=1e-14)


def test_roll_lengths_broadcast(make_gear: Callable[..., Gear]) -> None:
    pair = helical_pair(make_gear)
    first, second = pair.roll_lengths(np.linspace(0.0, 1.0, 5)[:, None], np.arange(-1, 2))
    assert first.shape == second.shape == (5, 3)
    assert pair.roll_lengths(0.5, -1)[0].shape == ()


def test_both_gears_turn_through_the_same_arc_of_their_base_circles(make_gear: Callable[..., Gear]) -> None:
    pair = helical_pair(make_gear)
    assert pair.wheel.base_radius / pair.pinion.base_radius == pytest.approx(pair.speed_ratio, rel=1e-14)
    assert sum(pair.operating_pitch_radii) == pytest.approx(pair.center_distance, rel=1e-14)


def test_default_center_distance_without_shift_is_the_sum_of_the_reference_radii(
    make_gear: Callable[..., Gear],
) -> None:
    pair = GearPair(
        make_gear(teeth=23, profile_shift_coefficient=0.2),
        make_gear(teeth=30, profile_shift_coefficient=-0.2),
    )
    assert pair.center_distance == pytest.approx(0.5 * 53 * 4e-3, rel=1e-14)
    assert pair.working_pressure_angle == pytest.approx(math.radians(20.0), rel=1e-12)


def test_default_center_distance_has_no_backlash_but_the_allowances(make_gear: Callable[..., Gear]) -> None:
    assert helical_pair(make_gear).transverse_base_backlash == pytest.approx(0.0, abs=1e-16)
    pair = helical_pair(make_gear, thickness_allowance=3e-5)
    # both teeth thinner by 30 um in the normal plane at the reference circle
    assert pair.normal_backlash == pytest.approx(2.0 * 3e-5 * math.cos(math.radians(20.0)), rel=1e-10)


def test_backlash_is_the_pitch_less_both_teeth_on_the_operating_pitch_circles(
    make_gear: Callable[..., Gear],
) -> None:
    tight = helical_pair(make_gear)
    pair = GearPair(tight.pinion, tight.wheel, tight.center_distance + 2e-4)
    thickness = 0.0
    for gear, radius in zip((pair.pinion, pair.wheel), pair.operating_pitch_radii, strict=True):
        angle = math.acos(gear.base_radius / radius)
        thickness += 2.0 * radius * (gear.base_thickness_half_angle - math.tan(angle) + angle)
    pitch = 2.0 * math.pi * pair.operating_pitch_radii[0] / pair.pinion.teeth
    assert pair.circumferential_backlash == pytest.approx(pitch - thickness, rel=1e-9)
    along_line = pair.circumferential_backlash * math.cos(pair.working_pressure_angle)
    assert pair.transverse_base_backlash == pytest.approx(along_line, rel=1e-12)
    assert pair.normal_backlash == pytest.approx(along_line * math.cos(pair.base_helix_angle), rel=1e-12)


def test_backlash_grows_with_center_distance_by_twice_its_sine(make_gear: Callable[..., Gear]) -> None:
    tight, step = helical_pair(make_gear), 1e-7
    wide = GearPair(tight.pinion, tight.wheel, tight.center_distance + 1e-4)
    wider = GearPair(tight.pinion, tight.wheel, tight.center_distance + 1e-4 + step)
    rate = (wider.transverse_base_backlash - wide.transverse_base_backlash) / step
    assert rate == pytest.approx(2.0 * math.sin(wide.working_pressure_angle), rel=1e-5)


def test_forces_close_the_triangle(make_gear: Callable[..., Gear]) -> None:
    pair = helical_pair(make_gear)
    normal = pair.normal_force(np.array([10.0, 100.0]))
    transverse, axial = pair.transverse_force(normal), pair.axial_force(normal)
    assert np.hypot(transverse, axial) == pytest.approx(normal, rel=1e-14)
    assert transverse * pair.pinion.base_radius == pytest.approx([10.0, 100.0], rel=1e-14)
    assert pair.torque(normal) == pytest.approx([10.0, 100.0], rel=1e-14)


def test_swapped_pair_runs_the_same_path_backwards(make_gear: Callable[..., Gear]) -> None:
    pair = helical_pair(make_gear)
    swapped = pair.swapped()
    assert swapped.swapped() == pair
    assert swapped.transverse_contact_ratio == pytest.approx(pair.transverse_contact_ratio, rel=1e-14)
    assert swapped.transverse_base_backlash == pytest.approx(pair.transverse_base_backlash, abs=1e-16)
    mirrored = pair.common_tangent - np.array(swapped.path_of_contact.points[::-1])
    assert mirrored == pytest.approx(np.array(pair.path_of_contact.points), rel=1e-12)
    assert swapped.base_helix_angle == -pair.base_helix_angle


@pytest.mark.parametrize(
    ("name", "pinion", "wheel"),
    [
        ("normal module", {}, {"normal_module": 4.1e-3}),
        ("pressure angle", {}, {"normal_pressure_angle": 0.36}),
        ("helix angle", {"helix_angle": 0.2}, {"helix_angle": 0.2}),
        ("helix angle", {"helix_angle": 0.2}, {"helix_angle": -0.21}),
        ("interference", {"teeth": 10}, {"teeth": 60}),
        ("interference", {"teeth": 60}, {"teeth": 10}),
        ("tip clearance", {"teeth": 24, "dedendum_coefficient": 0.98}, {"teeth": 26}),
        ("profile shift sum", {"profile_shift_coefficient": -1.2}, {"profile_shift_coefficient": -1.2}),
    ],
)
def test_strangers_are_refused_by_name(
    make_gear: Callable[..., Gear], name: str, pinion: dict[str, float], wheel: dict[str, float]
) -> None:
    first, second = make_gear(**({"teeth": 20} | pinion)), make_gear(**({"teeth": 20} | wheel))
    with pytest.raises(InfeasibleGeometry) as caught:
        GearPair(first, second)
    assert caught.value.name == name


@pytest.mark.parametrize(
    ("name", "distance"),
    [
        ("profile shift sum", 0.0799),
        ("profile shift sum", 0.07),
        ("contact ratio", 0.0825),
        ("contact ratio", 0.2),
    ],
)
def test_impossible_center_distance_is_refused_by_name(
    make_gear: Callable[..., Gear], name: str, distance: float
) -> None:
    with pytest.raises(InfeasibleGeometry) as caught:
        GearPair(make_gear(), make_gear(), distance)
    assert caught.value.name == name
    assert caught.value.field == "center_distance"


def test_refusal_of_jamming_teeth_tells_what_would_fit(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear(teeth=25, profile_shift_coefficient=0.2)
    with pytest.raises(InfeasibleGeometry) as caught:
        GearPair(gear, gear, 0.1008)
    words = str(caught.value.suggestion).rstrip(".").replace(",", "").split()
    distance, shift_sum = float(words[words.index("m") - 1]), float(words[words.index("instead") - 1])
    assert 0.0 <= GearPair(gear, gear, distance).transverse_base_backlash < 1e-7  # the last of seven digits
    fitting = make_gear(teeth=25, profile_shift_coefficient=0.5 * shift_sum)
    assert GearPair(fitting, fitting, 0.1008).transverse_base_backlash == pytest.approx(0.0, abs=4e-9)


@pytest.mark.parametrize("distance", [0.0, -1.0, math.nan, math.inf, "0.08"])
def test_center_distance_that_is_no_length_is_refused(
    make_gear: Callable[..., Gear], distance: float
) -> None:
    with pytest.raises(InputError) as caught:
        GearPair(make_gear(), make_gear(), distance)
    assert caught.value.field == "center_distance"


def test_tip_that_just_meets_the_form_circle_is_accepted(make_gear: Callable[..., Gear]) -> None:
    pinion = make_gear(teeth=10)
    with pytest.raises(InfeasibleGeometry) as caught:
        GearPair(pinion, make_gear(teeth=60))
    largest = float(str(caught.value.bound).split()[2])
    pair = GearPair(pinion, make_gear(teeth=60, tip_diameter=largest - 1e-8))
    assert pair.path_of_contact.start == pytest.approx(pinion.form_roll_length, abs=1e-6)


def test_tip_that_cuts_the_mating_fillet_off_the_line_of_action_is_refused(
    make_gear: Callable[..., Gear],
) -> None:
    # a large shift sum on a low rack: both tips clear the form circles on the line of action
    rack = {"dedendum_coefficient": 1.13, "root_radius_coefficient": 0.27}
    pinion = make_gear(teeth=39, profile_shift_coefficient=0.51, **rack)
    wheel = make_gear(teeth=43, profile_shift_coefficient=0.71, **rack)
    with pytest.raises(InfeasibleGeometry, match="fillet") as caught:
        GearPair(pinion, wheel)
    assert caught.value.name == "interference"
    shorter = make_gear(
        teeth=43, profile_shift_coefficient=0.71, tip_diameter=2 * wheel.tip_radius - 4e-4, **rack
    )
    lower = make_gear(
        teeth=39, profile_shift_coefficient=0.51, tip_diameter=2 * pinion.tip_radius - 4e-4, **rack
    )
    GearPair(lower, shorter)


def test_the_common_face_follows_the_axial_offset():
    narrow = Gear(teeth=20, normal_module=4e-3, face_width=20e-3, bore_diameter=40e-3)
    wide = dataclasses.replace(narrow, face_width=30e-3)
    shifted = GearPair(narrow, wide, 80e-3, axial_offset=10e-3)
    assert shifted.common_face == pytest.approx((-5e-3, 10e-3))
    assert shifted.face_width == pytest.approx(15e-3)
    assert shifted.swapped().common_face == pytest.approx((-15e-3, 0.0))


def test_gears_beside_each_other_are_refused():
    gear = Gear(teeth=20, normal_module=4e-3, face_width=20e-3, bore_diameter=40e-3)
    with pytest.raises(InfeasibleGeometry, match="face overlap"):
        GearPair(gear, gear, 80e-3, axial_offset=20e-3)
