"""External and internal pairs: path of contact, backlash, forces, and what a refusal suggests."""

import dataclasses
import math
import re
from typing import Any

import numpy as np
import pytest
from spur_gears import gear as bored
from spur_gears import make_gear, make_ring

from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry import Gear, GearPair, ParallelAxes, RingGear
from fe_contact.geometry.backlash import reference_center_distance
from fe_contact.geometry.gear_pair import InternalGearPair
from fe_contact.involute import involute_function

MODULE = 4e-3


def gear(teeth: int = 30, **fields: Any) -> Gear:
    return make_gear(teeth, **fields)


def ring(teeth: int = 80, **fields: Any) -> RingGear:
    return make_ring(teeth, **({"rim_diameter": 1.3 * MODULE * teeth, "addendum_coefficient": 0.8} | fields))


def external(allowances: tuple[float, float] = (3e-5, 3e-5)) -> GearPair:
    first, second = allowances
    pinion = gear(23, helix_angle=0.3, profile_shift_coefficient=0.3, thickness_allowance=first)
    wheel = gear(47, helix_angle=-0.3, profile_shift_coefficient=0.1, thickness_allowance=second)
    return GearPair(pinion, wheel)


def internal(allowances: tuple[float, float] = (3e-5, 2e-5)) -> InternalGearPair:
    first, second = allowances
    pinion = gear(helix_angle=0.2, profile_shift_coefficient=0.3, thickness_allowance=first)
    wheel = ring(helix_angle=0.2, profile_shift_coefficient=-0.5, thickness_allowance=second)
    return InternalGearPair(pinion, wheel)


MAKERS = pytest.mark.parametrize("make", [external, internal])


def apart(pair: ParallelAxes, by: float) -> ParallelAxes:
    """Return the pair with more backlash: the gears of an internal one come closer."""
    return dataclasses.replace(pair, center_distance=pair.center_distance + pair.wheel.sign * by)


@MAKERS
def test_path_of_contact_and_contact_ratio_are_those_of_the_textbook(make):
    pair = make()
    sign, (start, inner, pitch, outer, end) = pair.wheel.sign, pair.path_of_contact.points
    assert end == pair.pinion.tip_roll_length
    assert pair.roll_lengths(pair.position(start))[1] == pytest.approx(pair.wheel.tip_roll_length, rel=1e-13)
    assert end - inner == pytest.approx(pair.base_pitch, rel=1e-14)
    assert outer - start == pytest.approx(pair.base_pitch, rel=1e-14)
    radius = math.hypot(pair.pinion.base_radius, pitch)
    assert radius == pytest.approx(pair.operating_pitch_radii[0], rel=1e-14)
    assert start < min(inner, pitch, outer) < max(inner, pitch, outer) < end
    assert sign < 0 or inner < outer
    tips = math.sqrt(pair.pinion.tip_radius**2 - pair.pinion.base_radius**2)
    tips += sign * math.sqrt(pair.wheel.tip_radius**2 - pair.wheel.base_radius**2)
    length = tips - sign * pair.center_distance * math.sin(pair.working_pressure_angle)
    assert pair.transverse_contact_ratio == pytest.approx(length / pair.base_pitch, rel=1e-13)
    overlap = 25e-3 * math.tan(pair.pinion.helix_angle) / (math.pi * pair.pinion.transverse_module)
    assert pair.overlap_ratio == pytest.approx(overlap, rel=1e-14)
    assert pair.total_contact_ratio == pair.transverse_contact_ratio + pair.overlap_ratio


@MAKERS
def test_position_zero_is_the_pitch_point_and_one_position_is_one_base_pitch(make):
    pair = make()
    first, second = pair.roll_lengths(np.array([0.0, 0.25, 0.0]), np.array([0, 0, 1]))
    assert first[0] == pair.path_of_contact.pitch_point
    assert first[1] - first[0] == pytest.approx(0.25 * pair.base_pitch, rel=1e-12)
    assert first[2] - first[0] == pytest.approx(pair.base_pitch, rel=1e-12)  # pair +1 is ahead
    both = pair.wheel.sign * first + second
    assert both == pytest.approx(np.full(3, pair.common_tangent), rel=1e-12 if pair.internal else 1e-15)
    assert pair.position(first) == pytest.approx([0.0, 0.25, 1.0], abs=1e-14)
    first, second = pair.roll_lengths(np.linspace(0.0, 1.0, 5)[:, None], np.arange(-1, 2))
    assert first.shape == second.shape == (5, 3)
    assert pair.roll_lengths(0.5, -1)[0].shape == ()


@MAKERS
def test_the_gears_roll_on_their_operating_pitch_circles(make):
    pair = make()
    first, second = pair.operating_pitch_radii
    assert pair.wheel.sign * first + second == pytest.approx(pair.center_distance, rel=1e-14)
    assert second / first == pytest.approx(pair.speed_ratio, rel=1e-14)
    assert pair.wheel.base_radius / pair.pinion.base_radius == pytest.approx(pair.speed_ratio, rel=1e-14)


@MAKERS
def test_default_center_distance_has_no_backlash_but_the_allowances(make):
    assert make((0.0, 0.0)).transverse_base_backlash == pytest.approx(0.0, abs=1e-16)
    allowances = (3e-5, 2e-5)  # in the normal plane at the reference circle
    assert make(allowances).normal_backlash == pytest.approx(5e-5 * math.cos(math.radians(20.0)), rel=1e-9)


@pytest.mark.parametrize("kind", [GearPair, InternalGearPair])
def test_opposite_shifts_leave_the_center_distance(kind):
    wheel = (gear if kind is GearPair else ring)(53, profile_shift_coefficient=-0.2)
    pair = kind(gear(23, profile_shift_coefficient=0.2), wheel)
    assert pair.center_distance == pytest.approx(0.5 * (76 if kind is GearPair else 30) * MODULE, rel=1e-13)
    assert pair.working_pressure_angle == pytest.approx(math.radians(20.0), rel=1e-12)
    assert pair.transverse_base_backlash == pytest.approx(0.0, abs=1e-16)


@MAKERS
def test_backlash_is_the_pitch_less_both_teeth_on_the_operating_pitch_circles(make):
    pair = apart(make(), 1e-4)
    angle, thickness = pair.working_pressure_angle, 0.0
    for each, radius in zip((pair.pinion, pair.wheel), pair.operating_pitch_radii, strict=True):
        thickness += 2.0 * radius * (each.base_thickness_half_angle - each.sign * involute_function(angle))
    pitch = 2.0 * math.pi * pair.operating_pitch_radii[0] / pair.pinion.teeth
    assert pair.circumferential_backlash == pytest.approx(pitch - thickness, rel=1e-9)
    along_line = pair.circumferential_backlash * math.cos(angle)
    assert pair.transverse_base_backlash == pytest.approx(along_line, rel=1e-12)
    assert pair.normal_backlash == pytest.approx(along_line * math.cos(pair.base_helix_angle), rel=1e-12)


@MAKERS
def test_backlash_grows_by_twice_the_sine_of_the_way(make):
    near, middle, far = (apart(make(), 1e-4 + way) for way in (-1e-7, 0.0, 1e-7))
    rate = (far.transverse_base_backlash - near.transverse_base_backlash) / 2e-7
    assert rate == pytest.approx(2.0 * math.sin(middle.working_pressure_angle), rel=1e-6)


@MAKERS
def test_forces_close_the_triangle(make):
    pair = make()
    normal = pair.normal_force(np.array([10.0, 100.0]))
    transverse, axial = pair.transverse_force(normal), pair.axial_force(normal)
    assert np.hypot(transverse, axial) == pytest.approx(normal, rel=1e-14)
    assert transverse * pair.pinion.base_radius == pytest.approx([10.0, 100.0], rel=1e-14)
    assert pair.torque(normal) == pytest.approx([10.0, 100.0], rel=1e-14)
    assert pair.wheel.base_helix_angle == -pair.wheel.sign * pair.base_helix_angle


def test_swapped_pair_runs_the_same_path_backwards():
    pair = external((0.0, 0.0))
    swapped = pair.swapped()
    assert swapped.swapped() == pair
    assert swapped.transverse_contact_ratio == pytest.approx(pair.transverse_contact_ratio, rel=1e-14)
    assert swapped.transverse_base_backlash == pytest.approx(pair.transverse_base_backlash, abs=1e-16)
    mirrored = pair.common_tangent - np.array(swapped.path_of_contact.points[::-1])
    assert mirrored == pytest.approx(np.array(pair.path_of_contact.points), rel=1e-12)
    assert swapped.base_helix_angle == -pair.base_helix_angle


def test_worked_example_of_the_handbooks():
    # m 3 mm, 16 and 24 teeth, x_2 = +0.5 in the handbooks' sign (SDP/SI D785, KHK: table of internal gears)
    pinion = Gear(teeth=16, normal_module=3e-3, face_width=0.01, bore_diameter=2e-3)
    wheel = RingGear(
        24,
        3e-3,
        0.01,
        0.1,
        profile_shift_coefficient=-0.5,
        cutter_teeth=10,
        tip_diameter=0.071,
        root_radius_coefficient=0.0,
    )
    distance = reference_center_distance(pinion, wheel)
    cosine = (wheel.base_radius - pinion.base_radius) / distance
    assert distance == pytest.approx(13.1683e-3, abs=5e-8)
    assert math.degrees(math.acos(cosine)) == pytest.approx(31.0937, abs=1e-4)
    assert 2.0 * pinion.base_radius / cosine == pytest.approx(52.673e-3, abs=6e-7)
    assert 2.0 * wheel.base_radius / cosine == pytest.approx(79.010e-3, abs=6e-7)


def test_internal_flanks_touch_on_the_line_of_action_by_their_curvatures():
    pair = internal()
    position = np.linspace(-0.6, 0.6, 7)
    first, second = pair.roll_lengths(position)
    height = pair.pinion.base_radius / math.cos(pair.working_pressure_angle)
    for gear_, roll, center in ((pair.pinion, first, 0.0), (pair.wheel, second, -pair.center_distance)):
        # the normals touch the base circle on one ray from the gear's center, where the line of action starts
        angle = pair.working_pressure_angle
        foot = gear_.base_radius * np.array([-math.sin(angle), math.cos(angle)])
        point = foot + roll[:, None] * np.array([math.cos(angle), math.sin(angle)]) + np.array([0.0, center])
        along = (position * pair.base_pitch)[:, None] * np.array([math.cos(angle), math.sin(angle)])
        assert point == pytest.approx(np.array([0.0, height]) + along, rel=1e-12, abs=1e-15)
    assert second - first == pytest.approx(np.full(7, pair.common_tangent), rel=1e-12)
    assert pair.roll_lengths(0.0, 1)[0] - pair.roll_lengths(0.0)[0] == pytest.approx(
        pair.base_pitch, rel=1e-12
    )
    first, second = pair.roll_lengths(0.2)
    assert pair.relative_curvature(first) == pytest.approx(1.0 / first - 1.0 / second, rel=1e-14)
    pitch = pair.relative_curvature(pair.path_of_contact.pitch_point)
    r_1, r_2 = pair.operating_pitch_radii
    assert pitch * math.sin(pair.working_pressure_angle) == pytest.approx(1.0 / r_1 - 1.0 / r_2, rel=1e-12)


def test_ring_of_very_many_teeth_is_a_rack():
    pinion, errors = gear(), []
    for teeth in (1000, 4000):
        pair = InternalGearPair(pinion, ring(teeth))
        path, sine = pair.path_of_contact, math.sin(math.radians(20.0))
        rack_start = path.pitch_point - 0.8 * MODULE / sine
        curvature = pair.relative_curvature(path.pitch_point) * path.pitch_point
        errors.append([path.start - rack_start, curvature - 1.0])
    assert errors[0] == pytest.approx(4.0 * np.array(errors[1]), rel=0.02)  # first order in 1 / z_2
    assert abs(errors[1][0]) < 4e-3 * MODULE


def test_tip_clearances_of_an_internal_pair():
    pair = InternalGearPair(gear(), ring())
    assert pair.tip_clearances == pytest.approx((0.25 * MODULE, 0.45 * MODULE), rel=1e-10)


def test_refusal_of_jamming_teeth_tells_what_would_fit():
    alike = make_gear(teeth=25, profile_shift_coefficient=0.2)
    with pytest.raises(InfeasibleGeometry) as caught:
        GearPair(alike, alike, 0.1008)
    words = str(caught.value.suggestion).rstrip(".").replace(",", "").split()
    distance, shift_sum = float(words[words.index("m") - 1]), float(words[words.index("instead") - 1])
    assert 0.0 <= GearPair(alike, alike, distance).transverse_base_backlash < 1e-7  # the last of seven digits
    fitting = make_gear(teeth=25, profile_shift_coefficient=0.5 * shift_sum)
    assert GearPair(fitting, fitting, 0.1008).transverse_base_backlash == pytest.approx(0.0, abs=4e-9)
    with pytest.raises(InfeasibleGeometry) as caught:
        InternalGearPair(gear(), ring(), 0.1002)
    distance, total = (float(number) for number in re.findall(r"= ([\d.e-]+)", str(caught.value.suggestion)))
    assert (
        0.0 <= InternalGearPair(gear(), ring(), distance).transverse_base_backlash < 1e-7
    )  # a seventh digit
    fitting = InternalGearPair(
        gear(), ring(profile_shift_coefficient=total, addendum_coefficient=0.9), 0.1002
    )
    assert fitting.transverse_base_backlash == pytest.approx(0.0, abs=4e-9)


def test_refusal_of_a_tip_tells_the_tip_diameter_that_fits():
    with pytest.raises(InfeasibleGeometry) as caught:
        InternalGearPair(gear(), ring(addendum_coefficient=1.0))
    smallest = float(str(caught.value.bound).split()[2])
    pair = InternalGearPair(gear(), ring(tip_diameter=smallest + 1e-8))
    assert pair.path_of_contact.start == pytest.approx(pair.pinion.form_roll_length, abs=1e-7)
    with pytest.raises(InfeasibleGeometry) as caught:
        InternalGearPair(gear(addendum_coefficient=1.24), ring())
    largest = float(str(caught.value.bound).split()[2])
    pair = InternalGearPair(gear(tip_diameter=largest - 1e-8), ring())
    assert pair.roll_lengths(pair.position(pair.path_of_contact.end))[1] == pytest.approx(
        pair.wheel.form_roll_length, abs=1e-7
    )
    pinion = make_gear(teeth=10)
    with pytest.raises(InfeasibleGeometry) as caught:
        GearPair(pinion, make_gear(teeth=60))
    largest = float(str(caught.value.bound).split()[2])
    pair = GearPair(pinion, make_gear(teeth=60, tip_diameter=largest - 1e-8))
    assert pair.path_of_contact.start == pytest.approx(pinion.form_roll_length, abs=1e-6)


def test_tip_that_cuts_the_mating_fillet_off_the_line_of_action_is_refused():
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
    narrow = bored(face_width=20e-3)
    wide = dataclasses.replace(narrow, face_width=30e-3)
    shifted = GearPair(narrow, wide, 80e-3, axial_offset=10e-3)
    assert shifted.common_face == pytest.approx((-5e-3, 10e-3))
    assert shifted.face_width == pytest.approx(15e-3)
    assert shifted.swapped().common_face == pytest.approx((-15e-3, 0.0))
    gear = bored(face_width=20e-3)
    with pytest.raises(InfeasibleGeometry, match="face overlap"):
        GearPair(gear, gear, 80e-3, axial_offset=20e-3)
