from __future__ import annotations

import json
import math
import pickle
from collections.abc import Callable

import pytest

from fe_contact.geometry import FlankModification, Gear
from fe_contact.material import Material


def test_spur_gear_of_20_teeth(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear()
    assert gear.reference_radius == pytest.approx(0.04, rel=1e-15)
    assert gear.base_radius == pytest.approx(0.04 * math.cos(math.radians(20.0)), rel=1e-15)
    assert gear.tip_radius == pytest.approx(0.044, rel=1e-15)
    assert gear.root_radius == pytest.approx(0.035, rel=1e-15)
    assert gear.base_pitch == pytest.approx(math.pi * 4e-3 * math.cos(math.radians(20.0)), rel=1e-15)
    assert gear.tooth_thickness == pytest.approx(math.pi * 2e-3, rel=1e-15)


def test_base_and_tip_thickness_follow_the_textbook(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear(teeth=24, profile_shift_coefficient=0.25)
    involute = math.tan(math.radians(20.0)) - math.radians(20.0)
    half = gear.tooth_thickness / (2.0 * gear.reference_radius) + involute
    assert gear.base_tooth_thickness == pytest.approx(2.0 * gear.base_radius * half, rel=1e-14)
    tip = math.acos(gear.base_radius / gear.tip_radius)
    expected = 2.0 * gear.tip_radius * (half - math.tan(tip) + tip)
    assert gear.tip_tooth_thickness == pytest.approx(expected, rel=1e-12)


def test_helical_quantities_come_from_the_normal_plane(make_gear: Callable[..., Gear]) -> None:
    beta = math.radians(26.0)
    gear = make_gear(teeth=39, helix_angle=beta, profile_shift_coefficient=0.2)
    assert gear.transverse_module == pytest.approx(4e-3 / math.cos(beta))
    expected = math.tan(math.radians(20.0)) / math.cos(beta)
    assert math.tan(gear.transverse_pressure_angle) == pytest.approx(expected)
    # the two definitions of the base helix angle
    tangent = math.tan(beta) * math.cos(gear.transverse_pressure_angle)
    assert math.tan(gear.base_helix_angle) == pytest.approx(tangent, rel=1e-14)
    # profile shift multiplies the normal module
    assert gear.tip_radius - gear.reference_radius == pytest.approx(4e-3 * 1.2)
    assert gear.reference_radius - gear.root_radius == pytest.approx(4e-3 * 1.05)


def test_left_hand_changes_nothing_but_the_sign_of_the_base_helix(make_gear: Callable[..., Gear]) -> None:
    right, left = make_gear(helix_angle=0.2), make_gear(helix_angle=-0.2)
    assert left.base_helix_angle == -right.base_helix_angle
    for name in ("base_radius", "form_radius", "tip_radius", "base_tooth_thickness", "base_pitch"):
        assert getattr(left, name) == getattr(right, name)


def test_form_point_without_undercut_is_generated_by_the_end_of_the_tool_flank(
    make_gear: Callable[..., Gear],
) -> None:
    # ISO 21771-1: d_Ff from the end of the straight flank of the rack, h_Fa0 = h_fP - rho_fP (1 - sin alpha)
    gear, alpha = make_gear(teeth=40), math.radians(20.0)
    straight = 4e-3 * (1.25 - 0.38 * (1.0 - math.sin(alpha)))
    roll = gear.reference_radius * math.sin(alpha) - straight / math.sin(alpha)
    assert gear.form_roll_length == pytest.approx(roll, rel=1e-13)
    assert gear.form_radius == pytest.approx(math.hypot(gear.base_radius, roll), rel=1e-15)


def test_undercut_begins_where_the_textbook_says(make_gear: Callable[..., Gear]) -> None:
    # sharp tool, h_fP = 1: z_min = 2 / sin^2(20 deg) = 17.1, and x_min = 1 - z/z_min
    sharp = {"root_radius_coefficient": 0.0, "dedendum_coefficient": 1.0, "teeth": 12}
    shift = 1.0 - 12.0 * math.sin(math.radians(20.0)) ** 2 / 2.0
    assert not make_gear(profile_shift_coefficient=shift + 1e-6, **sharp).form_point.undercut
    assert make_gear(profile_shift_coefficient=shift - 1e-6, **sharp).form_point.undercut


def test_form_point_is_continuous_through_the_onset_of_undercut(make_gear: Callable[..., Gear]) -> None:
    sharp = {"root_radius_coefficient": 0.2, "dedendum_coefficient": 1.0, "teeth": 12}
    onset = 1.0 - 0.2 * (1.0 - math.sin(math.radians(20.0))) - 12.0 * math.sin(math.radians(20.0)) ** 2 / 2.0
    for offset in (1e-9, 1e-6, 1e-4):
        before = make_gear(profile_shift_coefficient=onset + offset, **sharp)
        after = make_gear(profile_shift_coefficient=onset - offset, **sharp)
        assert after.form_radius - before.form_radius == pytest.approx(0.0, abs=1e-2 * offset**2 + 1e-17)
        assert after.form_radius >= after.base_radius


def test_allowance_thins_the_tooth_and_keeps_the_root_circle(make_gear: Callable[..., Gear]) -> None:
    nominal, thin = make_gear(helix_angle=0.3), make_gear(helix_angle=0.3, thickness_allowance=8e-5)
    removed = nominal.tooth_thickness - thin.tooth_thickness
    assert removed * math.cos(0.3) == pytest.approx(8e-5, rel=1e-9)
    assert thin.root_radius == nominal.root_radius
    assert thin.form_roll_length == pytest.approx(nominal.form_roll_length, rel=1e-14)


def test_macro_geometry_is_plain_and_complete(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear(helix_angle=-0.0)
    facts = gear.macro_geometry()
    assert json.loads(json.dumps(facts)) == facts
    assert "-0.0" not in json.dumps(facts)
    same = make_gear(
        tip_diameter=2.0 * gear.tip_radius,
        addendum_coefficient=0.8,
        modification=FlankModification(profile_crowning=5e-6),
        material=Material(70e9),
    )
    assert same.macro_geometry() == facts
    changes = {
        "teeth": 21,
        "normal_module": 4.1e-3,
        "face_width": 0.026,
        "bore_diameter": 3e-3,
        "normal_pressure_angle": 0.36,
        "helix_angle": 0.1,
        "profile_shift_coefficient": 0.1,
        "addendum_coefficient": 0.9,
        "dedendum_coefficient": 1.2,
        "root_radius_coefficient": 0.3,
        "thickness_allowance": 1e-5,
    }
    for field, value in changes.items():
        assert make_gear(**{field: value}).macro_geometry() != facts, field


def test_gear_is_a_value(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear(profile_shift_coefficient=0.1)
    assert gear == make_gear(profile_shift_coefficient=0.1)
    assert hash(gear) == hash(make_gear(profile_shift_coefficient=0.1))
    assert gear.form_radius > 0.0  # fill its caches before it travels
    assert pickle.loads(pickle.dumps(gear)) == gear
