from __future__ import annotations

import dataclasses
import math
import re
from typing import Any

import numpy as np
import pytest

from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.flank.involute import involute_function
from fe_contact.geometry import Gear
from fe_contact.geometry.backlash import reference_center_distance
from fe_contact.geometry.gear_pair import InternalGearPair
from fe_contact.geometry.ring_gear import RingGear

MODULE = 4e-3


def gear(teeth: int = 30, **fields: Any) -> Gear:
    return Gear(
        teeth=teeth, **({"normal_module": MODULE, "face_width": 25e-3, "bore_diameter": 2e-3} | fields)
    )


def ring(teeth: int = 80, **fields: Any) -> RingGear:
    plain = {"normal_module": MODULE, "face_width": 25e-3, "rim_diameter": 1.3 * MODULE * teeth}
    return RingGear(teeth=teeth, **(plain | {"addendum_coefficient": 0.8} | fields))


def shifted(**fields: Any) -> InternalGearPair:
    pinion = gear(helix_angle=0.2, profile_shift_coefficient=0.3, thickness_allowance=3e-5)
    wheel = ring(helix_angle=0.2, profile_shift_coefficient=-0.5, thickness_allowance=2e-5)
    return InternalGearPair(pinion, wheel, **fields)


def test_worked_example_of_the_handbooks() -> None:
    # m 3 mm, 16 and 24 teeth, x_2 = +0.5 in the handbooks' sign (SDP/SI D785, KHK: table of internal gears)
    pinion = Gear(teeth=16, normal_module=3e-3, face_width=0.01, bore_diameter=2e-3)
    wheel = RingGear(
        teeth=24,
        normal_module=3e-3,
        face_width=0.01,
        rim_diameter=0.1,
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


def test_pinion_and_ring_roll_on_their_operating_pitch_circles() -> None:
    pair = shifted()
    first, second = pair.operating_pitch_radii
    assert second - first == pytest.approx(pair.center_distance, rel=1e-14)
    assert second / first == pytest.approx(pair.speed_ratio, rel=1e-14)
    assert math.hypot(pair.pinion.base_radius, pair.path_of_contact.pitch_point) == pytest.approx(
        first, rel=1e-14
    )


def test_both_flanks_touch_at_one_point_of_the_line_of_action() -> None:
    pair = shifted()
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


def test_path_of_contact_runs_from_the_rings_tip_to_the_pinions() -> None:
    pair = shifted()
    start, inner, pitch, outer, end = pair.path_of_contact.points
    assert pair.roll_lengths(pair.position(start))[1] == pytest.approx(pair.wheel.tip_roll_length, rel=1e-13)
    assert end == pair.pinion.tip_roll_length
    assert start < min(inner, pitch, outer) < max(inner, pitch, outer) < end
    tips = pair.pinion.tip_roll_length - pair.wheel.tip_roll_length
    length = tips + pair.center_distance * math.sin(pair.working_pressure_angle)
    assert pair.transverse_contact_ratio == pytest.approx(length / pair.base_pitch, rel=1e-13)
    assert pair.total_contact_ratio == pair.transverse_contact_ratio + pair.overlap_ratio


def test_relative_curvature_is_the_difference_of_a_bulging_and_a_hollow_flank() -> None:
    pair = shifted()
    first, second = pair.roll_lengths(0.2)
    assert pair.relative_curvature(first) == pytest.approx(1.0 / first - 1.0 / second, rel=1e-14)
    pitch = pair.relative_curvature(pair.path_of_contact.pitch_point)
    r_1, r_2 = pair.operating_pitch_radii
    assert pitch * math.sin(pair.working_pressure_angle) == pytest.approx(1.0 / r_1 - 1.0 / r_2, rel=1e-12)


def test_backlash_is_the_pitch_less_both_teeth_on_the_operating_pitch_circles() -> None:
    tight = shifted()
    pair = dataclasses.replace(tight, center_distance=tight.center_distance - 1e-4)
    angle, (first, second) = pair.working_pressure_angle, pair.operating_pitch_radii
    thickness = 2.0 * first * (pair.pinion.base_thickness_half_angle - involute_function(angle))
    thickness += 2.0 * second * (pair.wheel.base_thickness_half_angle + involute_function(angle))
    pitch = 2.0 * math.pi * first / pair.pinion.teeth
    assert pair.circumferential_backlash == pytest.approx(pitch - thickness, rel=1e-9)
    assert pair.normal_backlash == pytest.approx(
        pair.circumferential_backlash * math.cos(angle) * math.cos(pair.base_helix_angle), rel=1e-12
    )


def test_default_distance_leaves_the_allowances_as_backlash_and_closing_in_adds_to_it() -> None:
    pair = shifted()
    # both allowances in the normal plane at the reference circle
    assert pair.normal_backlash == pytest.approx(5e-5 * math.cos(math.radians(20.0)), rel=1e-9)
    step = 1e-7
    near, far = (
        dataclasses.replace(pair, center_distance=pair.center_distance - 1e-4 + side)
        for side in (-step, step)
    )
    rate = (far.transverse_base_backlash - near.transverse_base_backlash) / (2.0 * step)
    middle = dataclasses.replace(pair, center_distance=pair.center_distance - 1e-4)
    assert rate == pytest.approx(-2.0 * math.sin(middle.working_pressure_angle), rel=1e-6)


def test_opposite_shifts_leave_the_center_distance() -> None:
    pair = InternalGearPair(gear(profile_shift_coefficient=0.3), ring(profile_shift_coefficient=-0.3))
    assert pair.center_distance == pytest.approx(0.5 * 50 * MODULE, rel=1e-13)
    assert pair.transverse_base_backlash == pytest.approx(0.0, abs=1e-16)


def test_forces_close_the_triangle() -> None:
    pair = shifted()
    normal = pair.normal_force(100.0)
    assert np.hypot(pair.transverse_force(normal), pair.axial_force(normal)) == pytest.approx(
        normal, rel=1e-14
    )
    assert pair.transverse_force(normal) * pair.pinion.base_radius == pytest.approx(100.0, rel=1e-14)
    assert pair.base_helix_angle == pair.wheel.base_helix_angle


def test_ring_of_very_many_teeth_is_a_rack() -> None:
    pinion, errors = gear(), []
    for teeth in (1000, 4000):
        pair = InternalGearPair(pinion, ring(teeth))
        path, sine = pair.path_of_contact, math.sin(math.radians(20.0))
        rack_start = path.pitch_point - 0.8 * MODULE / sine
        curvature = pair.relative_curvature(path.pitch_point) * path.pitch_point
        errors.append([path.start - rack_start, curvature - 1.0])
    assert errors[0] == pytest.approx(4.0 * np.array(errors[1]), rel=0.02)  # first order in 1 / z_2
    assert abs(errors[1][0]) < 4e-3 * MODULE


def test_tip_clearances_and_tooth_number_difference() -> None:
    pair = InternalGearPair(gear(), ring())
    assert pair.tip_clearances == pytest.approx((0.25 * MODULE, 0.45 * MODULE), rel=1e-10)
    assert pair.tooth_number_difference == 50


@pytest.mark.parametrize(
    ("name", "field", "pinion", "wheel", "pair"),
    [
        ("normal module", "wheel.normal_module", {}, {"normal_module": 4.1e-3}, {}),
        ("pressure angle", "wheel.normal_pressure_angle", {}, {"normal_pressure_angle": 0.36}, {}),
        ("helix angle", "wheel.helix_angle", {"helix_angle": 0.2}, {"helix_angle": -0.2}, {}),
        ("tooth number difference", "wheel.teeth", {"teeth": 80}, {}, {}),
        ("face overlap", "axial_offset", {}, {}, {"axial_offset": 0.03}),
        ("center distance", "center_distance", {}, {}, {"center_distance": 0.0939}),
        ("profile shift sum", "center_distance", {}, {}, {"center_distance": 0.1001}),
        ("profile shift sum", "profile_shift_coefficient", {"profile_shift_coefficient": 1.2}, {}, {}),
        (
            "contact ratio",
            "center_distance",
            {"addendum_coefficient": 0.3},
            {"addendum_coefficient": 0.2},
            {},
        ),
        ("tip clearance", "pinion.tip_diameter", {"addendum_coefficient": 1.3}, {}, {}),
        (
            "tip clearance",
            "wheel.tip_diameter",
            {"dedendum_coefficient": 0.78, "root_radius_coefficient": 0.0},
            {},
            {},
        ),
        ("interference", "wheel.tip_diameter", {}, {"addendum_coefficient": 1.0}, {}),
        ("interference", "wheel.tip_diameter", {"teeth": 12}, {"teeth": 60}, {}),
        ("interference", "pinion.tip_diameter", {"addendum_coefficient": 1.24}, {}, {}),
        ("tip interference", "wheel.tip_diameter", {"teeth": 73}, {}, {}),
        ("trimming interference", "radial_assembly", {"teeth": 70}, {}, {"radial_assembly": True}),
    ],
)
def test_pairs_that_cannot_run_are_refused_by_name(
    name: str, field: str, pinion: dict[str, Any], wheel: dict[str, Any], pair: dict[str, Any]
) -> None:
    with pytest.raises(InfeasibleGeometry) as caught:
        InternalGearPair(gear(**pinion), ring(**wheel), **pair)
    assert (caught.value.name, caught.value.field) == (name, field)


def test_refusal_of_jamming_teeth_tells_what_would_fit() -> None:
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


def test_refusal_of_a_tip_tells_the_tip_diameter_that_fits() -> None:
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


@pytest.mark.parametrize("distance", [0.0, -0.1, math.nan, "0.1"])
def test_center_distance_that_is_no_length_is_refused(distance: float) -> None:
    with pytest.raises(InputError) as caught:
        InternalGearPair(gear(), ring(), distance)
    assert caught.value.field == "center_distance"
