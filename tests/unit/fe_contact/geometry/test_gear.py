"""Closed forms of gears and ring gears, of their involutes, and of the mesh stiffness of the standard."""

import dataclasses
import json
import math
import pickle

import numpy as np
import pytest
from spur_gears import make_gear, make_ring

from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.geometry import FlankModification, GearPair, iso6336_stiffness
from fe_contact.involute import (
    inverse_involute,
    involute_function,
    involute_normal,
    involute_point,
    roll_length_at_radius,
)
from fe_contact.material import Material


def test_circles_and_thicknesses_follow_the_textbook():
    gear = make_gear()
    assert gear.reference_radius == pytest.approx(0.04, rel=1e-15)
    assert gear.base_radius == pytest.approx(0.04 * math.cos(math.radians(20.0)), rel=1e-15)
    assert gear.tip_radius == pytest.approx(0.044, rel=1e-15)
    assert gear.root_radius == pytest.approx(0.035, rel=1e-15)
    assert gear.base_pitch == pytest.approx(math.pi * 4e-3 * math.cos(math.radians(20.0)), rel=1e-15)
    assert gear.tooth_thickness == pytest.approx(math.pi * 2e-3, rel=1e-15)
    gear = make_gear(teeth=24, profile_shift_coefficient=0.25)
    involute = math.tan(math.radians(20.0)) - math.radians(20.0)
    half = gear.tooth_thickness / (2.0 * gear.reference_radius) + involute
    assert gear.base_tooth_thickness == pytest.approx(2.0 * gear.base_radius * half, rel=1e-14)
    tip = math.acos(gear.base_radius / gear.tip_radius)
    expected = 2.0 * gear.tip_radius * (half - math.tan(tip) + tip)
    assert gear.tip_tooth_thickness == pytest.approx(expected, rel=1e-12)


def test_helical_quantities_come_from_the_normal_plane():
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


def test_left_hand_and_allowance_change_what_they_should():
    right, left = make_gear(helix_angle=0.2), make_gear(helix_angle=-0.2)
    assert left.base_helix_angle == -right.base_helix_angle
    for name in ("base_radius", "form_radius", "tip_radius", "base_tooth_thickness", "base_pitch"):
        assert getattr(left, name) == getattr(right, name)
    nominal = make_gear(helix_angle=0.3)
    thin = make_gear(helix_angle=0.3, thickness_allowance=8e-5, tooth_thinning="flank")
    removed = nominal.tooth_thickness - thin.tooth_thickness
    assert removed * math.cos(0.3) == pytest.approx(8e-5, rel=1e-9)
    assert thin.root_radius == nominal.root_radius
    assert thin.form_roll_length == pytest.approx(nominal.form_roll_length, rel=1e-14)


def test_form_point_without_undercut_is_generated_by_the_end_of_the_tool_flank():
    # ISO 21771-1: d_Ff from the end of the straight flank of the rack, h_Fa0 = h_fP - rho_fP (1 - sin alpha)
    gear, alpha = make_gear(teeth=40), math.radians(20.0)
    straight = 4e-3 * (1.25 - 0.38 * (1.0 - math.sin(alpha)))
    roll = gear.reference_radius * math.sin(alpha) - straight / math.sin(alpha)
    assert gear.form_roll_length == pytest.approx(roll, rel=1e-13)
    assert gear.form_radius == pytest.approx(math.hypot(gear.base_radius, roll), rel=1e-15)


def test_undercut_begins_where_the_textbook_says():
    sharp = {"root_radius_coefficient": 0.0, "dedendum_coefficient": 1.0, "teeth": 12}
    shift = 1.0 - 12.0 * math.sin(math.radians(20.0)) ** 2 / 2.0
    assert not make_gear(profile_shift_coefficient=shift + 1e-6, **sharp).form_point.undercut
    assert make_gear(profile_shift_coefficient=shift - 1e-6, **sharp).form_point.undercut
    sharp = {"root_radius_coefficient": 0.2, "dedendum_coefficient": 1.0, "teeth": 12}
    onset = 1.0 - 0.2 * (1.0 - math.sin(math.radians(20.0))) - 12.0 * math.sin(math.radians(20.0)) ** 2 / 2.0
    for offset in (1e-9, 1e-6, 1e-4):
        before = make_gear(profile_shift_coefficient=onset + offset, **sharp)
        after = make_gear(profile_shift_coefficient=onset - offset, **sharp)
        assert after.form_radius - before.form_radius == pytest.approx(0.0, abs=1e-2 * offset**2 + 1e-17)
        assert after.form_radius >= after.base_radius
    gear = make_gear(teeth=9)
    assert gear.form_point.undercut
    assert gear.base_radius < gear.form_radius < gear.tip_radius
    tool = {"normal_pressure_angle": math.radians(14.5), "dedendum_coefficient": 1.6}
    with pytest.raises(InfeasibleGeometry, match=r"undercut.*cut the tooth off"):
        make_gear(5, profile_shift_coefficient=-0.3, bore_diameter=1e-4, root_radius_coefficient=0.1, **tool)


def test_macro_geometry_is_plain_and_complete():
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


def test_gear_is_a_value():
    gear = make_gear(profile_shift_coefficient=0.1)
    assert gear == make_gear(profile_shift_coefficient=0.1)
    assert hash(gear) == hash(make_gear(profile_shift_coefficient=0.1))
    assert gear.form_radius > 0.0  # fill its caches before it travels
    assert pickle.loads(pickle.dumps(gear)) == gear


@pytest.mark.parametrize(
    "fields",
    [
        {},
        {"teeth": 97, "helix_angle": 0.3, "profile_shift_coefficient": -0.4, "thickness_allowance": 5e-5},
        {"teeth": 97, "helix_angle": 0.3, "thickness_allowance": 5e-5, "tooth_thinning": "flank"},
        {"teeth": 80, "profile_shift_coefficient": 0.2, "addendum_coefficient": 0.7},
    ],
)
def test_closed_forms_are_the_standards_with_a_negative_tooth_number(fields):
    gear = make_ring(**fields)
    module, x = gear.normal_module, gear.profile_shift_coefficient
    transverse = math.atan(math.tan(gear.normal_pressure_angle) / math.cos(gear.helix_angle))
    d = -gear.teeth * module / math.cos(gear.helix_angle)
    d_b = d * math.cos(transverse)
    d_a = d + 2.0 * module * (gear.addendum_coefficient + x)
    infeed = 0.5 * gear.thickness_allowance / math.tan(gear.normal_pressure_angle)
    x_e = x if gear.tooth_thinning == "flank" else x - infeed / module
    d_f = d - 2.0 * module * (gear.dedendum_coefficient - x_e)
    s_t = module * (0.5 * math.pi + 2.0 * x * math.tan(gear.normal_pressure_angle)) - gear.thickness_allowance
    s_t /= math.cos(gear.helix_angle)
    inv_a = math.tan(math.acos(d_b / d_a)) - math.acos(d_b / d_a)
    s_a = d_a * (s_t / d + math.tan(transverse) - transverse - inv_a)
    assert gear.base_radius == pytest.approx(-0.5 * d_b, rel=1e-14)
    assert gear.tip_radius == pytest.approx(-0.5 * d_a, rel=1e-14)
    assert gear.root_radius == pytest.approx(-0.5 * d_f, rel=1e-14)
    assert gear.tooth_thickness == pytest.approx(s_t, rel=1e-14)
    assert gear.tip_tooth_thickness == pytest.approx(s_a, rel=1e-11)
    assert gear.base_pitch == pytest.approx(math.pi * d_b / -gear.teeth, rel=1e-14)
    assert gear.tip_radius < gear.form_radius < gear.root_radius
    assert gear.tip_roll_length < gear.form_roll_length


def test_cutter_and_ring_fill_the_pitch_on_their_generating_circles():
    gear = make_ring(
        profile_shift_coefficient=-0.4, cutter_profile_shift_coefficient=0.1, thickness_allowance=6e-5
    )
    cutter = gear.cutter
    angle = cutter.working_pressure_angle
    involute = math.tan(angle) - angle
    ring_circle = cutter.pitch_radius / cutter.ratio
    assert ring_circle - cutter.pitch_radius == pytest.approx(cutter.center_distance, rel=1e-12)
    arcs = 2.0 * cutter.pitch_radius * (cutter.base_half_angle - involute)
    arcs += 2.0 * ring_circle * (gear.base_thickness_half_angle + involute)
    assert arcs == pytest.approx(2.0 * math.pi * ring_circle / gear.teeth, rel=1e-12)
    assert cutter.center_distance + cutter.tip_radius == pytest.approx(gear.root_radius, rel=1e-14)


def test_every_number_of_the_shape_is_in_the_macro_geometry_and_no_other():
    gear = make_ring()
    changed = {
        "teeth": 61,
        "normal_module": 4.1e-3,
        "face_width": 26e-3,
        "rim_diameter": 0.31,
        "normal_pressure_angle": math.radians(21.0),
        "helix_angle": 0.1,
        "profile_shift_coefficient": -0.1,
        "addendum_coefficient": 0.9,
        "dedendum_coefficient": 1.2,
        "root_radius_coefficient": 0.15,
        "cutter_teeth": 26,
        "cutter_profile_shift_coefficient": -0.05,
        "tip_diameter": 0.2325,
        "thickness_allowance": 1e-5,
    }
    for name, value in changed.items():
        assert dataclasses.replace(gear, **{name: value}).macro_geometry() != gear.macro_geometry(), name
    relieved = dataclasses.replace(gear, modification=FlankModification(profile_crowning=5e-6))
    assert relieved.macro_geometry() == gear.macro_geometry()
    assert gear.macro_geometry()["teeth"] == -60  # never the hash of an external gear


def test_modification_counts_from_the_tip_inwards_as_on_an_external_gear():
    relief = FlankModification(
        tip_relief=20e-6,
        tip_relief_length=1e-3,
        root_relief=10e-6,
        root_relief_length=5e-4,
        profile_slope=4e-6,
    )
    gear = make_ring(modification=relief)
    plain = dataclasses.replace(relief, profile_slope=0.0)
    tip, form = gear.tip_roll_length, gear.form_roll_length
    start = gear.roll_length(gear.tip_radius + 1e-3)
    removed = plain.material_removed(gear, np.array([tip, start, 0.5 * (start + form), form]))
    assert removed == pytest.approx([20e-6, 0.0, 0.0, 10e-6], rel=1e-12, abs=1e-20)
    assert plain.material_removed(gear, 0.5 * (tip + start)) == pytest.approx(10e-6, rel=1e-9, abs=0.0)
    sloped = relief.material_removed(gear, np.array([tip, form]))
    assert sloped - np.array([20e-6, 10e-6]) == pytest.approx([2e-6, -2e-6], rel=1e-9, abs=0.0)


def test_involute_function_is_tabulated_and_inverted():
    assert involute_function(math.radians(20.0)) == pytest.approx(0.014904384, abs=5e-10)
    assert inverse_involute(0.0) == 0.0
    with pytest.raises(ValueError, match="involute function"):
        inverse_involute(-1e-9)
    base = 0.0375877
    for roll in (0.0, 1e-4, 0.0137, 0.03):
        assert roll_length_at_radius(base, math.hypot(base, roll)) == pytest.approx(roll, abs=1e-12)


@pytest.mark.parametrize("degrees", [1e-3, 0.5, 5.0, 20.0, 45.0, 70.0, 89.0])
def test_inverse_involute_undoes_the_involute_function(degrees):
    angle = math.radians(degrees)
    # tan(a) - a loses a^2/3 of its digits at small angles
    assert inverse_involute(involute_function(angle)) == pytest.approx(angle, rel=1e-14 + 1e-15 / angle**2)


def test_point_is_one_roll_length_along_its_normal_from_the_base_circle():
    base, half, roll = 0.04, 0.1, np.linspace(0.0, 0.03, 7)
    foot = involute_point(base, half, roll) - roll[:, None] * involute_normal(base, half, roll)
    assert np.hypot(*foot.T) == pytest.approx(np.full(7, base), rel=1e-14)
    # the string unwound from the base circle is as long as the arc it covered
    assert base * (half - np.arctan2(foot[:, 0], foot[:, 1])) == pytest.approx(roll, abs=1e-15)
    base, half, roll, step = 0.04, 0.1, np.linspace(0.001, 0.03, 9), 1e-7
    normal = involute_normal(base, half, roll)
    tangent = involute_point(base, half, roll + step) - involute_point(base, half, roll - step)
    assert np.hypot(*normal.T) == pytest.approx(np.ones(9), rel=1e-15)
    assert np.sum(normal * tangent, axis=1) / np.hypot(*tangent.T) == pytest.approx(np.zeros(9), abs=1e-7)


def test_mesh_stiffness_follows_the_standard():
    pair = GearPair(make_gear(teeth=23, helix_angle=0.3), make_gear(teeth=47, helix_angle=-0.3))
    stiffness = iso6336_stiffness(pair)
    expected = stiffness.single_stiffness * (0.75 * pair.transverse_contact_ratio + 0.25)
    assert stiffness.mesh_stiffness == pytest.approx(expected, rel=1e-14)
    assert stiffness.face_load_mesh_stiffness == pytest.approx(0.85 * expected, rel=1e-14)
    pair = GearPair(make_gear(), make_gear())
    full = iso6336_stiffness(pair)
    reduced = iso6336_stiffness(pair, line_load=1e5 / 16.0)
    assert reduced.mesh_stiffness == pytest.approx(0.5 * full.mesh_stiffness, rel=1e-14)
    assert iso6336_stiffness(pair, line_load=2e5) == full
    with pytest.raises(InputError, match="line_load"):
        iso6336_stiffness(pair, line_load=0.0)
    steel = GearPair(make_gear(), make_gear())
    soft = GearPair(make_gear(), make_gear(material=Material(70e9)))
    ratio = iso6336_stiffness(soft).single_stiffness / iso6336_stiffness(steel).single_stiffness
    assert ratio == pytest.approx(2.0 * 70.0 / (210.0 + 70.0), rel=1e-14)
    pair = GearPair(make_gear(teeth=25), make_gear(teeth=25))
    large = GearPair(make_gear(teeth=25, normal_module=8e-3), make_gear(teeth=25, normal_module=8e-3))
    assert iso6336_stiffness(pair.swapped()) == iso6336_stiffness(pair)
    unlike = GearPair(
        make_gear(profile_shift_coefficient=0.4), make_gear(teeth=47, profile_shift_coefficient=0.1)
    )
    assert iso6336_stiffness(unlike.swapped()) == iso6336_stiffness(unlike)
    assert iso6336_stiffness(large).mesh_stiffness == pytest.approx(
        iso6336_stiffness(pair).mesh_stiffness, rel=1e-12
    )
