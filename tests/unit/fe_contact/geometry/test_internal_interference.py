"""Interference of internal pairs against brute force: exact outlines, turned and moved, point by point."""

import math
from functools import lru_cache
from typing import Any

import numpy as np
import pytest

from fe_contact import Gear, InternalGearPair, RingGear
from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry import ToothProfile, gear_pair, tooth_profile
from fe_contact.geometry.tip_interference import (
    flank_angle,
    pinion_edge_path,
    ring_edge_path,
    tip_interference,
    trochoidal_interference,
)
from fe_contact.geometry.trimming import radial_clearance
from fe_contact.involute import involute_function
from fe_contact.types import FloatArray

MODULE = 4e-3
SLACK = 1e-5 * MODULE  # of the sampled outlines


def make_pair(
    teeth: tuple[int, int], pinion: dict[str, Any], wheel: dict[str, Any], **fields: Any
) -> InternalGearPair:
    shared = {"normal_module": MODULE, "face_width": 25e-3}
    first = Gear(teeth=teeth[0], bore_diameter=2e-3, **(shared | pinion))
    plain = {
        "addendum_coefficient": 0.8,
        "root_radius_coefficient": 0.1,
        "rim_diameter": 1.3 * MODULE * teeth[1],
    }
    return InternalGearPair(first, RingGear(teeth=teeth[1], **(shared | plain | wheel)), **fields)


@pytest.fixture
def unchecked(monkeypatch):
    """Let pairs be made that cannot run."""
    monkeypatch.setattr(gear_pair, "refuse_infeasible_pair", lambda pair: None)


@lru_cache
def outline(profile: ToothProfile) -> FloatArray:
    """Polar angle and radius (n, 2) of one tooth's right flank, dense, rising in radius."""
    s = np.linspace(profile.s_root, profile.s_tip, 6001)
    x, y = profile.flank(s).T
    polar = np.stack((np.arctan2(x, y), np.hypot(x, y)), axis=1)
    return polar[np.argsort(polar[:, 1])]


def overlap(pair: InternalGearPair, turn: float, withdrawn: float = 0.0, centered: float = 0.0) -> float:
    """Largest arc in m by which an outline point of one gear lies inside the other; negative: all apart.

    The driving flanks touch, the pinion `turn` past its pitch point; then it is turned back by `centered`
    of the backlash and withdrawn along the line of centers.
    """
    first, second = outline(tooth_profile(pair.pinion)), outline(tooth_profile(pair.wheel))
    working = involute_function(pair.working_pressure_angle)
    lag = centered * pair.transverse_base_backlash / pair.pinion.base_radius
    center_1 = turn - pair.pinion.base_thickness_half_angle + working - lag
    center_2 = turn / pair.speed_ratio + pair.wheel.base_thickness_half_angle + working
    height = pair.center_distance - withdrawn
    pinion_in_ring = inside(first, pair.pinion.teeth, center_1, height, second, pair.wheel.teeth, center_2)
    ring_in_pinion = inside(second, pair.wheel.teeth, center_2, -height, first, pair.pinion.teeth, center_1)
    return max(pinion_in_ring, ring_in_pinion)


def inside(
    mover: FloatArray,
    teeth: int,
    center: float,
    height: float,
    fixed: FloatArray,
    fixed_teeth: int,
    zero: float,
) -> float:
    """Largest depth of the mover's flanks, its center at `height`, in the teeth of the other gear."""
    sparse, radius = outline_points(mover)
    turn = center + 2.0 * math.pi / teeth * np.arange(teeth)[:, None]
    along = sparse[0] * np.cos(turn) - sparse[1] * np.sin(turn)  # towards the line of centers, of all teeth
    square = height**2 + radius**2 + 2.0 * height * along
    within = (square >= fixed[0, 1] ** 2) & (square <= fixed[-1, 1] ** 2)  # few teeth are near the other gear
    tooth, point = np.nonzero(within)
    x = sparse[1, point] * np.cos(turn[tooth, 0]) + sparse[0, point] * np.sin(turn[tooth, 0])
    distance, pitch = np.sqrt(square[within]), 2.0 * math.pi / fixed_teeth
    beside = np.abs((np.arctan2(x, height + along[within]) - zero + 0.5 * pitch) % pitch - 0.5 * pitch)
    depth = distance * (np.interp(distance, fixed[:, 1], fixed[:, 0]) - beside)
    return float(np.max(depth, initial=-np.inf))


def outline_points(flank: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points (along, across) of both flanks of a tooth on the line of centers, and their radii."""
    sparse = flank[:: len(flank) // 300]
    angle, radius = np.concatenate((sparse[:, 0], -sparse[:, 0])), np.tile(sparse[:, 1], 2)
    return np.stack((radius * np.cos(angle), radius * np.sin(angle))), radius


def worst(pair: InternalGearPair) -> float:
    """Largest overlap over one pitch."""
    turns = 2.0 * math.pi / pair.pinion.teeth * np.linspace(-0.5, 0.5, 81)
    return max(overlap(pair, turn) for turn in turns)


RUNNING: list[tuple[tuple[int, int], dict[str, Any], dict[str, Any]]] = [
    ((30, 80), {}, {}),
    ((72, 80), {}, {}),
    ((25, 60), {"profile_shift_coefficient": 0.4}, {"profile_shift_coefficient": -0.6}),
    ((41, 97), {"helix_angle": 0.3, "thickness_allowance": 5e-5}, {"helix_angle": 0.3}),
    ((78, 80), {"addendum_coefficient": 0.6}, {"profile_shift_coefficient": -0.8, "tip_diameter": 0.3184}),
]


@pytest.mark.parametrize(("teeth", "pinion", "wheel"), RUNNING)
def test_feasible_pair_touches_and_never_overlaps(teeth, pinion, wheel):
    pair = make_pair(teeth, pinion, wheel)
    assert abs(worst(pair)) < SLACK


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize("difference", [7, 6, 5])
def test_tip_interference_is_the_overlap_of_the_turning_outlines(difference):
    pair = make_pair((80 - difference, 80), {}, {})
    depth = tip_interference(pair)
    assert depth > 1e-5
    assert worst(pair) == pytest.approx(depth, rel=0.05, abs=0.0)


@pytest.mark.usefixtures("unchecked")
def test_trochoidal_interference_is_the_overlap_of_the_turning_outlines():
    # the ring's tip reaches the pinion's fillet, cut by a rack with a large rounding
    pair = make_pair((30, 80), {"dedendum_coefficient": 1.1}, {"addendum_coefficient": 1.02})
    depth = trochoidal_interference(pair)
    assert depth > 1e-5
    assert worst(pair) == pytest.approx(depth, rel=0.05, abs=0.0)
    # the pinion's tip reaches the ring's fillet
    pair = make_pair((60, 80), {"addendum_coefficient": 1.2}, {"root_radius_coefficient": 0.3})
    depth = trochoidal_interference(pair)
    assert depth > 1e-5
    assert worst(pair) == pytest.approx(depth, rel=0.05, abs=0.0)


OFF_THE_LINE: list[tuple[tuple[int, int], dict[str, Any], dict[str, Any]]] = [
    (
        (12, 115),
        {"profile_shift_coefficient": 0.39, "root_radius_coefficient": 0.03, "tip_diameter": 58.784e-3},
        {
            "profile_shift_coefficient": -0.76,
            "dedendum_coefficient": 0.95,
            "root_radius_coefficient": 0.31,
            "cutter_teeth": 20,
            "tip_diameter": 457.76e-3,
        },
    ),
    (
        (63, 108),
        {
            "profile_shift_coefficient": -0.45,
            "dedendum_coefficient": 1.27,
            "root_radius_coefficient": 0.15,
            "tip_diameter": 258.594e-3,
        },
        {
            "profile_shift_coefficient": -0.95,
            "dedendum_coefficient": 1.13,
            "root_radius_coefficient": 0.07,
            "cutter_teeth": 35,
            "tip_diameter": 427.811e-3,
        },
    ),
]


@pytest.mark.parametrize(("teeth", "pinion", "wheel"), OFF_THE_LINE)
def test_a_tip_that_clears_the_form_circle_but_cuts_the_fillet_is_refused(monkeypatch, teeth, pinion, wheel):
    with pytest.raises(InfeasibleGeometry) as caught:
        make_pair(teeth, pinion, wheel)
    assert caught.value.name == "trochoidal interference"
    monkeypatch.setattr(gear_pair, "refuse_infeasible_pair", lambda pair: None)
    pair = make_pair(teeth, pinion, wheel)
    assert tip_interference(pair) < SLACK
    assert worst(pair) == pytest.approx(trochoidal_interference(pair), rel=0.1, abs=0.0)


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize("teeth", [(60, 80), (72, 80), (74, 80)])
def test_ends_of_the_edges_paths_are_the_handbooks_angle_criterion(teeth):
    pair = make_pair(teeth, {}, {})
    a, r_1, r_2 = pair.center_distance, pair.pinion.tip_radius, pair.wheel.tip_radius
    working = involute_function(pair.working_pressure_angle)
    inv_1 = involute_function(math.acos(pair.pinion.base_radius / r_1))
    inv_2 = involute_function(math.acos(pair.wheel.base_radius / r_2))
    theta_1 = math.acos((r_2**2 - r_1**2 - a**2) / (2.0 * a * r_1)) + inv_1 - working
    theta_2 = math.acos((a**2 + r_2**2 - r_1**2) / (2.0 * a * r_2))
    left_over = theta_1 * teeth[0] / teeth[1] + working - inv_2 - theta_2  # SDP/SI D785, eq. 5-6: >= 0
    path = pinion_edge_path(pair)
    assert path.radius[-1] == pytest.approx(r_2, rel=1e-12)
    assert path.depth[-1] == pytest.approx(-r_2 * left_over, rel=1e-9, abs=0.0)
    mate = ring_edge_path(pair)
    assert mate.radius[-1] == pytest.approx(r_1, rel=1e-12)
    # the same meeting of the two edges, seen from the pinion
    assert mate.depth[-1] == pytest.approx(-r_1 * left_over * teeth[1] / teeth[0], rel=1e-6, abs=0.0)


def test_edges_touch_the_mating_flank_at_the_ends_of_the_path_of_contact():
    pair = make_pair((40, 80), {}, {})
    for path, mate, roll in (
        (pinion_edge_path(pair), pair.wheel, pair.common_tangent + pair.path_of_contact.end),
        (ring_edge_path(pair), pair.pinion, pair.path_of_contact.start),
    ):
        on_involute = mate.sign * (path.radius - mate.form_radius) > 0.0
        at_contact = np.argmax(np.where(on_involute, path.depth, -np.inf))
        assert -1e-7 < path.depth[at_contact] <= 1e-15
        assert path.radius[at_contact] == pytest.approx(math.hypot(mate.base_radius, roll), rel=1e-3)
    for profile in (tooth_profile(pair.pinion), tooth_profile(pair.wheel)):
        s = np.linspace(profile.s_root, profile.s_tip, 97)[3:]
        x, y = profile.flank(s).T
        assert flank_angle(profile.gear, np.hypot(x, y)) == pytest.approx(np.arctan2(x, y), abs=1e-6)


def radially_blocked(pair: InternalGearPair) -> bool:
    """Whether some phase of the pinion, in the middle of its backlash, cannot be withdrawn radially."""
    turns = 2.0 * math.pi / pair.pinion.teeth * np.linspace(-0.5, 0.5, 31)
    ways = pair.center_distance * np.linspace(0.0, 1.0, 41)[1:]
    return any(overlap(pair, turn, way, centered=0.5) > 1e-9 for turn in turns for way in ways)


@pytest.mark.law
@pytest.mark.parametrize(("shortening", "blocked"), [(0.05e-3, True), (-0.05e-3, False)])
@pytest.mark.parametrize("allowance", [0.0, 1e-4])
def test_trimming_interference_is_found_by_withdrawing_the_pinion(shortening, blocked, allowance):
    def at_tip(diameter):
        return make_pair((68, 80), {"thickness_allowance": allowance}, {"tip_diameter": diameter})

    low, high = 0.3130, 0.3180
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if at_tip(middle).radial_assembly_clearance < 0.0 else (low, middle)
    assert 0.3131 < low < 0.3179
    pair = at_tip(low - shortening * 8.0)
    assert (pair.radial_assembly_clearance < 0.0) == blocked
    assert radially_blocked(pair) == blocked


def test_radial_clearance_at_its_limits():
    alpha = math.radians(20.0)
    assert radial_clearance(0.5, (alpha, alpha), alpha) == math.inf
    assert radial_clearance(0.9, (math.radians(30.0), math.radians(15.0)), alpha) == -math.inf
    # continuous up to the pinion as large as the bore, where both edges move across at a right angle
    ratio, first = 0.8, math.radians(40.0)
    second = math.acos(math.cos(first) / ratio * (1.0 - 1e-12))
    turn = 0.5 * math.pi * (1.0 - 1.0 / ratio)
    turn += involute_function(first) - involute_function(alpha)
    turn -= (involute_function(second) - involute_function(alpha)) / ratio
    assert radial_clearance(ratio, (first, second), alpha) == pytest.approx(turn, abs=1e-4)
