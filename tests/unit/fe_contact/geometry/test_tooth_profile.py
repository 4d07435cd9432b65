from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fe_contact.errors import InputError
from fe_contact.geometry import Gear, tooth_profile

SMOOTH: list[dict[str, Any]] = [
    {"teeth": 20},
    {"teeth": 150, "profile_shift_coefficient": -0.2},
    {"teeth": 43, "profile_shift_coefficient": 0.5, "helix_angle": 0.4},
    {"teeth": 12, "profile_shift_coefficient": 0.6, "root_radius_coefficient": 0.45},
]
UNDERCUT: list[dict[str, Any]] = [{"teeth": 9}, {"teeth": 12, "root_radius_coefficient": 0.0}]


@pytest.mark.parametrize("fields", SMOOTH + UNDERCUT)
def test_coordinate_is_the_arc_length_everywhere(
    make_gear: Callable[..., Gear], fields: dict[str, Any]
) -> None:
    profile = tooth_profile(make_gear(**fields))
    for low, high in (
        (profile.s_space, profile.s_root),
        (profile.s_root, profile.s_form),
        (profile.s_form, profile.s_tip),
    ):
        s = np.linspace(low + 1e-15, high, 4001)
        chord = np.hypot(*np.diff(profile.flank(s), axis=0).T)
        assert np.sum(chord) == pytest.approx(high - low, rel=1e-7)
        assert np.max(np.abs(chord[1:] / np.diff(s)[1:] - 1.0)) < 2e-6


@pytest.mark.parametrize("fields", SMOOTH + UNDERCUT)
def test_normals_are_unit_and_perpendicular(make_gear: Callable[..., Gear], fields: dict[str, Any]) -> None:
    profile, step = tooth_profile(make_gear(**fields)), 1e-8
    for low, high in (
        (profile.s_space, profile.s_root),
        (profile.s_root, profile.s_form),
        (profile.s_form, profile.s_tip),
    ):
        s = np.linspace(low + 5 * step, high - 5 * step, 41)
        normal, tangent = (
            profile.normal(s),
            (profile.flank(s + step) - profile.flank(s - step)) / (2.0 * step),
        )
        assert np.hypot(*normal.T) == pytest.approx(np.ones(41), rel=1e-14)
        assert np.sum(normal * tangent, axis=1) == pytest.approx(np.zeros(41), abs=1e-6)
        # outward: turning the upward tangent clockwise
        assert np.all(normal[:, 0] * tangent[:, 1] - normal[:, 1] * tangent[:, 0] > 0.999)


@pytest.mark.parametrize("fields", SMOOTH + UNDERCUT)
def test_profile_is_continuous_at_form_point_and_root(
    make_gear: Callable[..., Gear], fields: dict[str, Any]
) -> None:
    profile, step = tooth_profile(make_gear(**fields)), 1e-12
    for joint in (profile.s_form, profile.s_root):
        jump = profile.flank(joint + step) - profile.flank(joint - step)
        assert np.hypot(*jump) < 3.0 * step
    radial = profile.normal(profile.s_root + step) - profile.normal(profile.s_root - step)
    assert np.hypot(*radial) < 1e-7


@pytest.mark.parametrize("fields", SMOOTH)
def test_fillet_leaves_the_involute_with_its_tangent(
    make_gear: Callable[..., Gear], fields: dict[str, Any]
) -> None:
    profile = tooth_profile(make_gear(**fields))
    assert not profile.gear.form_point.undercut
    kink = profile.normal(profile.s_form) - profile.normal(profile.s_form - 1e-13)
    assert np.hypot(*kink) < 1e-9


@pytest.mark.parametrize("fields", UNDERCUT)
def test_undercut_makes_a_kink(make_gear: Callable[..., Gear], fields: dict[str, Any]) -> None:
    profile = tooth_profile(make_gear(**fields))
    assert profile.gear.form_point.undercut
    kink = profile.normal(profile.s_form) - profile.normal(profile.s_form - 1e-13)
    assert np.hypot(*kink) > 0.1


def test_bounds_lie_on_their_circles(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear(teeth=23, profile_shift_coefficient=0.2)
    profile = tooth_profile(gear)
    s = np.array([profile.s_space, profile.s_root, profile.s_form, profile.s_tip])
    x, y = profile.flank(s).T
    expected = [gear.root_radius, gear.root_radius, gear.form_radius, gear.tip_radius]
    assert np.hypot(x, y) == pytest.approx(expected, rel=1e-13)
    assert math.atan2(x[0], y[0]) == pytest.approx(math.pi / 23, rel=1e-13)
    assert math.atan2(x[3], y[3]) == pytest.approx(profile.tip_angle, rel=1e-12)


def test_involute_coordinate_is_half_the_squared_roll_length_over_the_base_radius(
    make_gear: Callable[..., Gear],
) -> None:
    profile = tooth_profile(make_gear())
    roll = np.linspace(profile.gear.form_roll_length, profile.gear.tip_roll_length, 11)
    s = roll**2 / (2.0 * profile.gear.base_radius)
    assert profile.flank(s) == pytest.approx(profile.involute(roll), rel=1e-12)
    assert profile.roll_length(s) == pytest.approx(roll, rel=1e-14)


def test_thickness_at_the_reference_circle(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear(teeth=30, profile_shift_coefficient=0.3, helix_angle=0.2, thickness_allowance=5e-5)
    roll = np.array(gear.roll_length(gear.reference_radius))
    x, y = tooth_profile(gear).involute(roll)
    expected = gear.normal_module * (math.pi / 2 + 0.6 * math.tan(math.radians(20.0))) - 5e-5
    assert 2.0 * gear.reference_radius * math.atan2(x, y) * math.cos(0.2) == pytest.approx(
        expected, rel=1e-12
    )


def test_tip_land_runs_from_right_edge_to_left_edge(make_gear: Callable[..., Gear]) -> None:
    profile = tooth_profile(make_gear())
    right, middle, left = profile.tip_land(np.array([0.0, 0.5, 1.0]))
    assert right == pytest.approx(profile.flank(profile.s_tip), rel=1e-12)
    assert middle == pytest.approx([0.0, profile.gear.tip_radius], abs=1e-18)
    assert left == pytest.approx(right * [-1.0, 1.0])


def test_full_fillet_leaves_no_root_land(make_gear: Callable[..., Gear]) -> None:
    full = make_gear().basic_rack.full_fillet_coefficient
    profile = tooth_profile(make_gear(root_radius_coefficient=full))
    assert profile.s_root - profile.s_space == pytest.approx(0.0, abs=1e-15)
    assert profile.flank(profile.s_space) == pytest.approx(profile.fillet(profile.fillet_length), abs=1e-14)


def test_arrays_of_any_shape_and_scalars(make_gear: Callable[..., Gear]) -> None:
    profile = tooth_profile(make_gear())
    s = np.linspace(profile.s_space, profile.s_tip, 12).reshape(3, 4)
    assert profile.flank(s).shape == profile.normal(s).shape == (3, 4, 2)
    assert profile.flank(s)[1, 2] == pytest.approx(profile.flank(float(s[1, 2])), rel=1e-14)
    assert profile.flank([]).shape == (0, 2)


@pytest.mark.parametrize("beyond", [-1e-6, 1e-6, math.nan])
def test_coordinates_off_the_profile_are_refused(make_gear: Callable[..., Gear], beyond: float) -> None:
    profile = tooth_profile(make_gear())
    end = profile.s_space if beyond < 0.0 else profile.s_tip
    with pytest.raises(InputError, match="s_space"):
        profile.flank([profile.s_form, end + beyond])


def test_lengths_scale_and_the_hand_of_helix_does_not_matter(make_gear: Callable[..., Gear]) -> None:
    one = tooth_profile(make_gear(helix_angle=0.3))
    large = {"normal_module": 12e-3, "face_width": 75e-3, "bore_diameter": 6e-3}
    three = tooth_profile(make_gear(helix_angle=-0.3, **large))
    s = np.linspace(one.s_space, one.s_tip, 30)
    assert three.flank(3.0 * s) == pytest.approx(3.0 * one.flank(s), rel=1e-12)
    assert three.normal(3.0 * s) == pytest.approx(one.normal(s), abs=1e-12)


def test_profile_of_equal_gears_is_computed_once(make_gear: Callable[..., Gear]) -> None:
    assert tooth_profile(make_gear(teeth=31)) is tooth_profile(make_gear(teeth=31))
