from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from fe_contact.errors import InputError
from fe_contact.flank.involute import involute_point
from fe_contact.geometry.flank_profile import ToothProfile, tooth_profile
from fe_contact.geometry.ring_gear import RingGear
from fe_contact.types import FloatArray

RINGS: list[dict[str, Any]] = [
    {"teeth": 60},
    {"teeth": 60, "root_radius_coefficient": 0.0},
    {"teeth": 97, "helix_angle": 0.3, "profile_shift_coefficient": -0.3, "thickness_allowance": 5e-5},
    {"teeth": 300, "cutter_teeth": 40, "cutter_profile_shift_coefficient": 0.1},
]


def profile_of(fields: dict[str, Any]) -> ToothProfile:
    module = 4e-3
    rim = 1.5 * module * fields["teeth"]
    return tooth_profile(RingGear(normal_module=module, face_width=25e-3, rim_diameter=rim, **fields))


def parts(profile: ToothProfile) -> list[tuple[float, float]]:
    bounds = (profile.s_space, profile.s_root, profile.s_form, profile.s_tip)
    return list(itertools.pairwise(bounds))


@pytest.mark.parametrize("fields", RINGS)
def test_coordinate_is_the_arc_length_rising_to_the_tip(fields: dict[str, Any]) -> None:
    profile = profile_of(fields)
    for low, high in parts(profile):
        s = np.linspace(low + 1e-15, high, 4001)
        chord = np.hypot(*np.diff(profile.flank(s), axis=0).T)
        assert np.sum(chord) == pytest.approx(high - low, rel=1e-7)
        assert np.max(np.abs(chord[1:] / np.diff(s)[1:] - 1.0)) < 2e-6


@pytest.mark.parametrize("fields", RINGS)
def test_normals_are_unit_perpendicular_and_outward(fields: dict[str, Any]) -> None:
    profile, step = profile_of(fields), 1e-8
    for low, high in parts(profile):
        s = np.linspace(low + 5 * step, high - 5 * step, 41)
        normal, tangent = profile.normal(s), profile.flank(s + step) - profile.flank(s - step)
        tangent = tangent / (2.0 * step)
        assert np.hypot(*normal.T) == pytest.approx(np.ones(41), rel=1e-14)
        assert np.sum(normal * tangent, axis=1) == pytest.approx(np.zeros(41), abs=1e-6)
        # towards the tip the material is on the right of an inward tooth: outward is on the left
        assert np.all(normal[:, 0] * tangent[:, 1] - normal[:, 1] * tangent[:, 0] < -0.999)


@pytest.mark.parametrize("fields", RINGS)
def test_involute_fillet_and_root_circle_join(fields: dict[str, Any]) -> None:
    profile, step = profile_of(fields), 1e-12
    for joint in (profile.s_form, profile.s_root):
        assert np.hypot(*(profile.flank(joint + step) - profile.flank(joint - step))) < 3.0 * step
    if profile.gear.root_radius_coefficient > 0.0:
        for joint in (profile.s_form, profile.s_root):
            turn = profile.normal(joint + step) - profile.normal(joint - step)
            assert np.hypot(*turn) < 1e-7
    x, y = profile.flank(profile.s_space)
    assert math.atan2(x, y) == pytest.approx(math.pi / profile.gear.teeth, rel=1e-12)
    assert math.hypot(x, y) == pytest.approx(profile.gear.root_radius, rel=1e-12)
    assert np.hypot(*profile.flank(profile.s_tip)) == pytest.approx(profile.gear.tip_radius, rel=1e-12)


@pytest.mark.parametrize("fields", RINGS)
def test_thickness_of_the_profile_is_the_closed_form(fields: dict[str, Any]) -> None:
    profile = profile_of(fields)
    gear = profile.gear
    x, y = profile.involute(np.array([gear.roll_length(gear.reference_radius)]))[0]
    assert 2.0 * gear.reference_radius * math.atan2(x, y) == pytest.approx(gear.tooth_thickness, rel=1e-12)
    edge = profile.tip_land(np.array([0.0, 0.5, 1.0]))
    assert edge[0] == pytest.approx(profile.flank(profile.s_tip), rel=1e-12)
    assert edge[1] == pytest.approx([0.0, gear.tip_radius], abs=1e-18)


def turned(points: FloatArray, angle: float) -> FloatArray:
    """Points turned clockwise."""
    sine, cosine = math.sin(angle), math.cos(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack((x * cosine + y * sine, y * cosine - x * sine), axis=-1)


def cutter_flank(profile: ToothProfile) -> FloatArray:
    """Left flank of the cutter's tooth with its rounding, in the cutter's tooth frame."""
    cutter, tip = profile.gear.cutter, profile.gear.tip_roll_length
    roll = np.linspace(tip - cutter.common_tangent, cutter.flank_end_roll_length, 300)
    flank = involute_point(cutter.base_radius, cutter.base_half_angle, roll)
    polar = cutter.corner_angle
    middle = cutter.corner_center_radius * np.array([math.sin(polar), math.cos(polar)])
    start = math.atan2(*(flank[-1] - middle)[::-1]) if cutter.corner_radius else 0.0
    angle = np.linspace(start, 0.5 * math.pi - polar, 300)
    rounding = middle + cutter.corner_radius * np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    return np.concatenate((flank, rounding)) * np.array([-1.0, 1.0])


def swept(profile: ToothProfile) -> FloatArray:
    """All places of the cutter's flank in the ring's tooth frame while both roll."""
    cutter, tool = profile.gear.cutter, cutter_flank(profile)
    places = []
    for turn in np.linspace(-0.7, 0.7, 701):
        placed = turned(tool, turn) + np.array([0.0, cutter.center_distance])
        places.append(turned(placed, math.pi / profile.gear.teeth - turn * cutter.ratio))
    return np.concatenate(places)


@pytest.mark.law
@pytest.mark.parametrize("fields", RINGS)
def test_rolling_cutter_touches_the_whole_flank_and_cuts_it_nowhere(fields: dict[str, Any]) -> None:
    profile = profile_of(fields)
    s = np.linspace(profile.s_root, profile.s_tip, 3001)[1:-1]
    points, normals, places = profile.flank(s), profile.normal(s), swept(profile)
    near = places[np.hypot(*(places - points[s.size // 2]).T) < 4.0 * profile.gear.normal_module]
    distance, nearest = cKDTree(points).query(near)
    gap = np.sum((near - points[nearest]) * normals[nearest], axis=1)
    beside = np.abs(gap) > 0.9 * distance - 1e-6  # not past the ends of the sampled flank
    assert np.min(gap[beside]) > -1e-9
    closest = np.full(100, np.inf)  # in a hundred stretches of the flank
    np.minimum.at(closest, nearest[beside] * closest.size // s.size, gap[beside])
    assert np.max(closest) < 1e-7


def test_no_point_lies_outside_the_profile() -> None:
    profile = profile_of(RINGS[0])
    for s in (profile.s_space - 1e-6, profile.s_tip + 1e-6):
        with pytest.raises(InputError, match="s_space"):
            profile.flank(s)
    s = np.array([0.3 * profile.s_form + 0.7 * profile.s_tip])
    assert np.hypot(*profile.flank(s).T) ** 2 == pytest.approx(
        profile.gear.base_radius**2 + profile.roll_length(s) ** 2, rel=1e-13
    )
