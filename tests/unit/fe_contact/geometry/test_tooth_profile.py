"""Outlines of teeth: their coordinate, normals and joints, and that the tool which cuts them touches all."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree
from spur_gears import make_gear, make_ring

from fe_contact.errors import InputError
from fe_contact.geometry import Gear, tooth_profile
from fe_contact.geometry.flank_profile import ToothProfile
from fe_contact.involute import involute_point
from fe_contact.types import FloatArray

SMOOTH = {
    "20": make_gear(),
    "150": make_gear(150, profile_shift_coefficient=-0.2),
    "43 helical": make_gear(43, profile_shift_coefficient=0.5, helix_angle=0.4, thickness_allowance=5e-5),
    "12 round": make_gear(12, profile_shift_coefficient=0.6, root_radius_coefficient=0.45),
}
UNDERCUT = {"9 undercut": make_gear(9), "12 sharp": make_gear(12, root_radius_coefficient=0.0)}
RINGS = {
    "ring": make_ring(60),
    "ring sharp": make_ring(60, root_radius_coefficient=0.0),
    "ring helical": make_ring(
        97, helix_angle=0.3, profile_shift_coefficient=-0.3, thickness_allowance=5e-5, rim_diameter=0.582
    ),
    "ring 300": make_ring(300, cutter_teeth=40, cutter_profile_shift_coefficient=0.1, rim_diameter=1.8),
}
ALL = SMOOTH | UNDERCUT | RINGS
every_gear = pytest.mark.parametrize("gear", ALL.values(), ids=ALL)
gear_and_ring = pytest.mark.parametrize("gear", [ALL["20"], ALL["ring"]], ids=["gear", "ring"])


def parts(profile: ToothProfile) -> list[tuple[float, float]]:
    """Root circle, fillet and involute."""
    return list(itertools.pairwise((profile.s_space, profile.s_root, profile.s_form, profile.s_tip)))


@every_gear
def test_coordinate_is_the_arc_length_rising_to_the_tip(gear):
    profile = tooth_profile(gear)
    for low, high in parts(profile):
        s = np.linspace(low + 1e-15, high, 4001)
        chord = np.hypot(*np.diff(profile.flank(s), axis=0).T)
        assert np.sum(chord) == pytest.approx(high - low, rel=1e-7)
        assert np.max(np.abs(chord[1:] / np.diff(s)[1:] - 1.0)) < 2e-6


@every_gear
def test_normals_are_unit_perpendicular_and_outward(gear):
    profile, step = tooth_profile(gear), 1e-8
    for low, high in parts(profile):
        s = np.linspace(low + 5 * step, high - 5 * step, 41)
        normal = profile.normal(s)
        tangent = (profile.flank(s + step) - profile.flank(s - step)) / (2.0 * step)
        assert np.hypot(*normal.T) == pytest.approx(np.ones(41), rel=1e-14)
        assert np.sum(normal * tangent, axis=1) == pytest.approx(np.zeros(41), abs=1e-6)
        # the upward tangent is turned clockwise, that of an inward tooth the other way
        turned = normal[:, 0] * tangent[:, 1] - normal[:, 1] * tangent[:, 0]
        assert np.all(gear.sign * turned > 0.999)


@every_gear
def test_involute_fillet_and_root_circle_join_on_their_circles(gear):
    profile, step = tooth_profile(gear), 1e-12
    for joint in (profile.s_form, profile.s_root):
        assert np.hypot(*(profile.flank(joint + step) - profile.flank(joint - step))) < 3.0 * step
    if gear.sign > 0 or gear.root_radius_coefficient > 0.0:
        turn = profile.normal(profile.s_root + step) - profile.normal(profile.s_root - step)
        assert np.hypot(*turn) < 1e-7
    x, y = profile.flank(np.array([profile.s_space, profile.s_root, profile.s_form, profile.s_tip])).T
    circles = [gear.root_radius, gear.root_radius, gear.form_radius, gear.tip_radius]
    assert np.hypot(x, y) == pytest.approx(circles, rel=1e-13)
    assert math.atan2(x[0], y[0]) == pytest.approx(math.pi / gear.teeth, rel=1e-13)
    assert math.atan2(x[3], y[3]) == pytest.approx(profile.tip_angle, rel=1e-12)


@every_gear
def test_the_fillet_leaves_the_involute_with_its_tangent_or_an_undercut_with_a_kink(gear):
    profile = tooth_profile(gear)
    kink = np.hypot(*(profile.normal(profile.s_form) - profile.normal(profile.s_form - 1e-13)))
    if isinstance(gear, Gear):
        assert gear.form_point.undercut == (gear in UNDERCUT.values())
        assert kink > 0.1 if gear.form_point.undercut else kink < 1e-9
    elif gear.root_radius_coefficient > 0.0:
        assert kink < 1e-7


@every_gear
def test_thickness_at_the_reference_circle_is_the_closed_form(gear):
    x, y = tooth_profile(gear).involute(np.array([gear.roll_length(gear.reference_radius)]))[0]
    shift = 2.0 * gear.profile_shift_coefficient * math.tan(math.radians(20.0))
    normal = gear.normal_module * (math.pi / 2 + shift) - gear.thickness_allowance
    arc = 2.0 * gear.reference_radius * math.atan2(x, y)
    assert arc * math.cos(gear.helix_angle) == pytest.approx(normal, rel=1e-12)
    assert arc == pytest.approx(gear.tooth_thickness, rel=1e-12)


@gear_and_ring
def test_involute_coordinate_is_half_the_squared_roll_length_over_the_base_radius(gear):
    profile = tooth_profile(gear)
    roll = np.linspace(gear.form_roll_length, gear.tip_roll_length, 11)
    s = gear.sign * roll**2 / (2.0 * gear.base_radius)
    assert profile.flank(s) == pytest.approx(profile.involute(roll), rel=1e-12)
    assert profile.roll_length(s) == pytest.approx(roll, rel=1e-14)
    assert np.hypot(*profile.flank(s).T) ** 2 == pytest.approx(gear.base_radius**2 + roll**2, rel=1e-13)


@every_gear
def test_tip_land_runs_from_right_edge_to_left_edge(gear):
    profile = tooth_profile(gear)
    right, middle, left = profile.tip_land(np.array([0.0, 0.5, 1.0]))
    assert right == pytest.approx(profile.flank(profile.s_tip), rel=1e-12)
    assert middle == pytest.approx([0.0, gear.tip_radius], abs=1e-18)
    assert left == pytest.approx(right * [-1.0, 1.0])


def test_full_fillet_leaves_no_root_land():
    full = make_gear().basic_rack.full_fillet_coefficient
    # (pi/4 - 1.25 tan 20) cos 20 / (1 - sin 20), by hand
    assert full == pytest.approx(0.4719109, abs=5e-7)
    profile = tooth_profile(make_gear(root_radius_coefficient=full))
    assert profile.s_root - profile.s_space == pytest.approx(0.0, abs=1e-15)
    assert profile.flank(profile.s_space) == pytest.approx(profile.fillet(profile.fillet_length), abs=1e-14)


def test_arrays_scale_and_equal_gears_share_a_profile():
    profile = tooth_profile(make_gear())
    s = np.linspace(profile.s_space, profile.s_tip, 12).reshape(3, 4)
    assert profile.flank(s).shape == profile.normal(s).shape == (3, 4, 2)
    assert profile.flank(s)[1, 2] == pytest.approx(profile.flank(float(s[1, 2])), rel=1e-14)
    assert profile.flank([]).shape == (0, 2)
    one = tooth_profile(make_gear(helix_angle=0.3))
    large = {"normal_module": 12e-3, "face_width": 75e-3, "bore_diameter": 6e-3}
    three = tooth_profile(make_gear(helix_angle=-0.3, **large))
    s = np.linspace(one.s_space, one.s_tip, 30)
    assert three.flank(3.0 * s) == pytest.approx(3.0 * one.flank(s), rel=1e-12)
    assert three.normal(3.0 * s) == pytest.approx(one.normal(s), abs=1e-12)
    assert tooth_profile(make_gear(teeth=31)) is tooth_profile(make_gear(teeth=31))


@gear_and_ring
@pytest.mark.parametrize("beyond", [-1e-6, 1e-6, math.nan])
def test_coordinates_off_the_profile_are_refused(gear, beyond):
    profile = tooth_profile(gear)
    end = profile.s_space if beyond < 0.0 else profile.s_tip
    with pytest.raises(InputError, match="s_space"):
        profile.flank([profile.s_form, end + beyond])


# The tool of a ring gear: a cutter.


def turned(points: FloatArray, angle: float) -> FloatArray:
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


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("ring", RINGS.values(), ids=RINGS)
def test_rolling_cutter_touches_the_whole_flank_and_cuts_it_nowhere(ring):
    profile = tooth_profile(ring)
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


# The tool of a gear: a rack.

CASES: list[dict[str, Any]] = [
    {"teeth": 20},
    {"teeth": 9},  # undercut
    {"teeth": 200, "profile_shift_coefficient": -0.4},
    {"teeth": 43, "profile_shift_coefficient": 0.6, "root_radius_coefficient": 0.2},
    {"teeth": 25, "helix_angle": math.radians(30.0)},
    {"teeth": 12, "helix_angle": math.radians(-26.0), "root_radius_coefficient": 0.45},
    {"teeth": 11, "root_radius_coefficient": 0.0},  # sharp tool, undercut
    {"teeth": 24, "thickness_allowance": 1e-4},
    {"teeth": 24, "thickness_allowance": 1e-4, "tooth_thinning": "flank"},
    {"teeth": 17, "thickness_allowance": 2e-4, "helix_angle": 0.3},
    {
        "teeth": 15,
        "profile_shift_coefficient": 1.1,
        "addendum_coefficient": 0.4,
        "root_radius_coefficient": 0.4,
    },
]


NAMES = [
    " ".join(value if isinstance(value, str) else f"{key}={value:.3g}" for key, value in case.items())
    for case in CASES
]


cases = pytest.mark.parametrize("fields", CASES, ids=NAMES)


def clearance_to_tool_rounding(gear: Gear, point: np.ndarray) -> float:
    """Smallest distance of a point of the gear to the tool's rounding while the gear rolls past the tool.

    From the definition: the gear turns by phi, its reference circle rolling on the tool's pitch line; the
    rounding is a circle in the normal plane, where distances along the pitch line shrink by cos(beta). The
    tool is the basic rack, deeper by the infeed of the allowance; before ground flanks it is wider instead.
    """
    rho, reference = gear.root_radius_coefficient * gear.normal_module, gear.reference_radius
    alpha, beta = gear.normal_pressure_angle, gear.helix_angle
    ground = gear.thickness_allowance if gear.tooth_thinning == "flank" else 0.0
    infeed = 0.5 * (gear.thickness_allowance - ground) / math.tan(alpha)
    shift = gear.normal_module * gear.profile_shift_coefficient - infeed
    depth = gear.normal_module * gear.dedendum_coefficient - shift
    half_tooth = 0.25 * math.pi * gear.normal_module + shift * math.tan(alpha) - 0.5 * ground
    center_x = half_tooth + (depth - rho) * math.tan(alpha) + rho / math.cos(alpha)

    def distance(turn):
        across = point[0] * np.cos(turn) - point[1] * np.sin(turn) + reference * turn
        up = point[0] * np.sin(turn) + point[1] * np.cos(turn) - reference
        return np.hypot(across * math.cos(beta) - center_x, up + depth - rho)

    turns = np.linspace(-1.2, 1.2, 2001) * min(1.0, 12.0 / gear.teeth)
    nearest, step = turns[np.argmin(distance(turns))], turns[1] - turns[0]
    for _ in range(4):  # closer and closer grids: safe for the sharp tool's kinked distance too
        turns = nearest + step * np.linspace(-1.0, 1.0, 401)
        nearest, step = turns[np.argmin(distance(turns))], step / 200.0
    return float(distance(nearest)) - rho


@cases
def test_tool_touches_every_fillet_point_and_cuts_no_involute(fields):
    gear = make_gear(**fields)
    profile = tooth_profile(gear)
    points = profile.fillet(np.linspace(0.0, profile.fillet_length, 9))
    clearance = [clearance_to_tool_rounding(gear, point) for point in points]
    assert clearance == pytest.approx(np.zeros(9), abs=1e-11)
    points = tooth_profile(gear).involute(np.linspace(gear.form_roll_length, gear.tip_roll_length, 9))
    assert min(clearance_to_tool_rounding(gear, point) for point in points) >= -1e-11


def test_undercut_removes_the_involute_below_the_form_point():
    gear = make_gear(teeth=9)
    below = tooth_profile(gear).involute(np.array([0.5 * gear.form_roll_length]))[0]
    assert clearance_to_tool_rounding(gear, below) < -1e-5
    gear = make_gear(teeth=17, helix_angle=0.3)
    angle = np.linspace(gear.normal_pressure_angle, 0.5 * math.pi, 20)
    x, y = gear.trochoid.point(angle).T
    assert np.arctan2(x, y) == pytest.approx(gear.trochoid.polar_angle(angle), rel=1e-13)
    assert np.hypot(x, y) == pytest.approx(gear.trochoid.radius(angle), rel=1e-13)


@cases
def test_radius_falls_along_an_arc_of_known_length(fields):
    gear = make_gear(**fields)
    radius = gear.trochoid.radius(np.linspace(gear.form_point.tool_angle, 0.5 * math.pi, 100))
    assert np.all(np.diff(radius) < 0.0)
    assert radius[0] == pytest.approx(gear.form_radius, rel=1e-13)
    assert radius[-1] == pytest.approx(gear.root_radius, rel=1e-13)
    start, trochoid = gear.form_point.tool_angle, gear.trochoid
    angle = np.linspace(start, 0.5 * math.pi, 50)
    arc = trochoid.arc_length(start, angle)
    assert trochoid.angle_at_arc(start, arc) == pytest.approx(angle, rel=1e-12)
    # against the chord sum, whose error falls with the square of the step
    fine = trochoid.point(np.linspace(start, 0.5 * math.pi, 20001))
    assert arc[-1] == pytest.approx(np.sum(np.hypot(*np.diff(fine, axis=0).T)), rel=1e-8)
