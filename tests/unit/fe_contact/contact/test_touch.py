"""Where rigid modified flanks come closest."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from fe_contact import FlankModification, Gear, GearPair
from fe_contact.contact.plain_touch import conjugate_touch
from fe_contact.contact.touch import modified_touch
from fe_contact.effects.flank_modification import ModificationGap
from fe_contact.flank.relief_shape import SHAPES
from fe_contact.geometry import InternalGearPair, RingGear, corner_contact, edge_gap


def pair(**modification: object) -> GearPair:
    gear = Gear(20, 4e-3, 25e-3, 40e-3, modification=FlankModification(**modification))
    return GearPair(gear, gear, 80e-3)


class Removed:
    """Material removed from both flanks."""

    along_profile = True
    only_removes = False
    grids = (None, None)

    def breaks(self, gears, face):
        return ModificationGap(gears.pinion.modification, gears.wheel.modification).breaks(gears, face)

    def __call__(self, gears, roll_1, roll_2, face):
        return material_removed(gears, roll_1, roll_2)


class Constant(Removed):
    def breaks(self, gears, face):
        return ()

    def __call__(self, gears, roll_1, roll_2, face):
        return np.full(roll_1.shape, 3e-6)


def material_removed(gears, roll_1, roll_2):
    return gears.pinion.modification.material_removed(
        gears.pinion, roll_1
    ) + gears.wheel.modification.material_removed(gears.wheel, roll_2)


def touches(gears, position, terms):
    roll_1, roll_2 = gears.roll_lengths(np.asarray(position)[:, None])
    plain = conjugate_touch(gears, roll_1, roll_2, corners=True)
    return plain, modified_touch(gears, plain, np.zeros(1), terms)


def test_no_modification_moves_nothing_and_a_constant_gap_only_adds():
    gears = pair()
    plain, modified = touches(gears, np.linspace(-0.9, 0.9, 41), (Removed(),))
    for name in plain.__dataclass_fields__:
        assert np.array_equal(getattr(modified, name), getattr(plain, name))
    plain, modified = touches(gears, [0.0, 0.3], (Constant(),))
    assert modified.gap == pytest.approx(plain.gap + 3e-6, abs=1e-15)
    assert modified.s_1 == pytest.approx(plain.s_1, abs=1e-12)


def test_a_relief_of_slope_m_touches_r_m_off_the_line_of_action_and_r_m2_over_2_earlier():
    """The least of (x - x0)^2/(2R) + m x is m x0 - R m^2/2 at x0 - R m."""
    gears = pair(tip_relief=10e-6, tip_relief_length=1.2e-3)
    position = [0.62]  # well within the relief of gear 1, away from its edge
    plain, modified = touches(gears, position, (Removed(),))
    gear = gears.pinion

    def at(s):
        return float(gear.modification.material_removed(gear, np.sqrt(2 * gear.base_radius * s)))

    s = float(plain.s_1[0, 0])
    slope = (at(s + 1e-7) - at(s - 1e-7)) / 2e-7
    radius = float(plain.radius[0, 0])
    assert slope > 5e-3
    assert modified.gap[0, 0] == pytest.approx(at(s) - radius * slope**2 / 2, abs=2e-9)
    assert modified.s_1[0, 0] == pytest.approx(s - radius * slope, abs=3e-6)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("position", [-0.72, -0.5, 0.3, 0.55, 0.7, 0.77])
def test_against_a_direct_search(position, shape):
    gears = pair(
        tip_relief=15e-6,
        tip_relief_length=0.9e-3,
        tip_relief_shape=shape,
        profile_crowning=2e-6,
        profile_crowning_root=3e-6,
        profile_crowning_root_length=3e-3,
    )
    plain, modified = touches(gears, [position], (Removed(),))
    s_1, s_2, radius = (float(value[0, 0]) for value in (plain.s_1, plain.s_2, plain.radius))
    tip = float(gears.pinion.flank_coordinate(gears.pinion.tip_roll_length))

    def gap(x):
        roll = np.sqrt(2 * gears.pinion.base_radius * np.array([s_1 + x, s_2 - x]))
        return x**2 / (2 * radius) + float(material_removed(gears, roll[:1], roll[1:])[0])

    found = min(
        minimize_scalar(gap, bounds=bounds, method="bounded", options={"xatol": 1e-12}).fun
        for bounds in ((max(-0.4e-3, s_2 - tip), 0.0), (0.0, min(0.4e-3, tip - s_1)))
    )
    assert modified.gap[0, 0] / modified.lag[0, 0] == pytest.approx(found, abs=1e-11)


SHED = {"tip_relief": 15e-6, "tip_relief_length": 0.9e-3, "root_relief": 9e-6, "root_relief_length": 0.7e-3}


@pytest.mark.parametrize("more", [{}, {"profile_crowning": 6e-6}, {"profile_slope": 12e-6}])
def test_samples_left_out_as_too_far_off_are_not_the_lowest(more, monkeypatch):
    gears = pair(**SHED, **more)
    term = ModificationGap(gears.pinion.modification, gears.wheel.modification)
    assert term.only_removes == ("profile_slope" not in more)
    position = np.linspace(-1.2, 1.2, 301)
    _, quick = touches(gears, position, (term,))
    monkeypatch.setattr(ModificationGap, "only_removes", False)
    _, whole = touches(gears, position, (term,))
    for name in whole.__dataclass_fields__:
        assert np.array_equal(getattr(quick, name), getattr(whole, name))


@pytest.mark.parametrize("face", [2e-3, 7e-3, 9.9e-3])
@pytest.mark.parametrize("shape", SHAPES)
def test_a_triangular_relief_against_a_direct_search_at_any_place_of_the_face(shape, face):
    """Its start runs aslant over the flank, which the breaks of the gap follow."""
    modification = FlankModification(
        triangular_tip_relief=12e-6, triangular_tip_relief_length=2.5e-3, triangular_tip_relief_shape=shape
    )
    pinion = Gear(23, 3e-3, 20e-3, 20e-3, helix_angle=math.radians(8.0), modification=modification)
    gears = GearPair(pinion, Gear(41, 3e-3, 20e-3, 40e-3, helix_angle=-math.radians(8.0)))
    (start,) = modification.relief_starts(pinion, np.array([face]))
    tip, begin = pinion.tip_roll_length, start.roll_length[0]
    assert begin < tip - 0.2e-3
    for roll in np.linspace(begin - 0.2e-3, tip - 0.1e-3, 7):
        there = np.array([[roll]])
        plain = conjugate_touch(gears, there, gears.mating_roll_length(there), corners=True)
        term = ModificationGap(modification, FlankModification())
        modified = modified_touch(gears, plain, np.array([face]), (term,))
        s_1, radius = float(plain.s_1[0, 0]), float(plain.radius[0, 0])
        reach = float(pinion.flank_coordinate(tip)) - s_1

        x = np.linspace(max(-0.4e-3, -0.3 * s_1), min(0.4e-3, reach), 4001)
        here = np.sqrt(2.0 * pinion.base_radius * (s_1 + x))
        gap = x**2 / (2.0 * radius) + modification.material_removed(pinion, here, face)
        assert modified.gap[0, 0] == pytest.approx(gap.min(), abs=1e-10)
        away = pinion.flank_coordinate(begin) - modified.s_1[0, 0]
        assert modified.offset[0, 0] == pytest.approx([away], abs=1e-12)
        assert modified.jump[0, 0] == pytest.approx(start.jump, rel=1e-12)


def test_gaps_run_over_the_start_of_a_relief_and_past_the_edge():
    gears = pair(tip_relief=20e-6, tip_relief_length=1.0e-3)
    position = np.linspace(0.3, 0.778, 2000)
    _, modified = touches(gears, position, (Removed(),))
    assert np.abs(np.diff(modified.gap[:, 0])).max() < 0.1e-6
    assert np.all(modified.gap >= 0.0)
    gears = pair(tip_relief=15e-6, tip_relief_length=0.9e-3)
    _, modified = touches(gears, np.linspace(-0.7, 0.7, 30), (Removed(),))
    tip = float(gears.pinion.flank_coordinate(gears.pinion.tip_roll_length))
    assert modified.offset_1 == pytest.approx(tip - modified.s_1, abs=1e-12)
    assert modified.offset_2 == pytest.approx(tip - modified.s_2, abs=1e-12)
    # Past E the edge is what touches unless the relief opens faster than the flanks.
    gears = pair(tip_relief=2e-6, tip_relief_length=1.2e-3)
    plain, modified = touches(gears, [0.81], (Removed(),))
    assert 0.0 < plain.gap[0, 0] < modified.gap[0, 0] <= plain.gap[0, 0] + 2e-6 + 1e-12
    assert modified.offset_1[0, 0] < 0.0
    # Flanks that open at an edge touch there, however little is removed: 1e-155 m is as good as none.
    gears, position = pair(profile_crowning=1e-155), np.linspace(0.65, 0.9, 26)
    plain, modified = touches(gears, position, (Removed(),))
    beyond = np.minimum(plain.offset_1, plain.offset_2) < 0.0
    assert beyond.sum() > 10
    assert modified.offset_1[beyond] == pytest.approx(plain.offset_1[beyond], rel=1e-12, abs=0.0)
    assert modified.offset_2[beyond] == pytest.approx(plain.offset_2[beyond], rel=1e-12, abs=0.0)


def test_touching_points_scale_with_all_lengths():
    """By a power of two to the last bit: no length is written into the search."""
    changes = {"tip_relief": 2e-6, "tip_relief_length": 1.5e-3, "profile_crowning": 3e-6}
    large, position = pair(**changes), np.linspace(-0.9, 0.9, 61)
    small = scaled_down(large, 2.0**-12)
    found, wanted = (touches(gears, position, (Removed(),))[1] for gears in (small, large))
    for name in ("s_1", "s_2", "offset_1", "offset_2", "gap", "radius"):
        assert getattr(found, name) == pytest.approx(2.0**-12 * getattr(wanted, name), rel=1e-9, abs=1e-18)


def scaled_down(gears, scale):
    lengths = ("tip_relief", "tip_relief_length", "profile_crowning")
    gear = gears.pinion
    modification = FlankModification(**{name: scale * getattr(gear.modification, name) for name in lengths})
    sizes = {name: scale * getattr(gear, name) for name in ("normal_module", "face_width", "bore_diameter")}
    small = Gear(teeth=gear.teeth, modification=modification, **sizes)
    return GearPair(small, small, scale * gears.center_distance)


def test_the_edge_of_a_ring_on_a_flatter_flank_has_a_radius():
    """Where the ring's hollow flank is the more curved one, the relative curvature would be below zero."""
    pinion = Gear(21, 1e-3, 10e-3, 8e-3, profile_shift_coefficient=0.37)
    gears = InternalGearPair(pinion, RingGear(50, 1e-3, 10e-3, rim_diameter=60e-3, addendum_coefficient=0.8))
    roll_1, roll_2 = gears.roll_lengths(np.linspace(0.0, 0.97, 33)[:, None], np.arange(-3, 4))
    found = conjugate_touch(gears, roll_1, roll_2, corners=True)
    flatter = np.isfinite(found.gap) & (found.s_1 * pinion.base_radius > -found.s_2 * gears.wheel.base_radius)
    assert flatter.sum() > 0
    assert np.all(found.radius[np.isfinite(found.gap)] > 0.0)
    assert found.radius[flatter] == pytest.approx(100.0 * gears.wheel.base_radius)


def ring_pair(**modification: object) -> InternalGearPair:
    shape = FlankModification(**modification)
    pinion = Gear(20, 4e-3, 25e-3, bore_diameter=40e-3, modification=shape)
    ring = RingGear(60, 4e-3, 25e-3, rim_diameter=300e-3, addendum_coefficient=0.8, modification=shape)
    return InternalGearPair(pinion, ring, 80e-3)


@pytest.mark.parametrize("make", [pair, ring_pair])
@pytest.mark.parametrize("side", ["exit", "approach"])
def test_the_edge_of_a_chamfer_touches_like_the_tip_of_a_shorter_tooth(make, side):
    """On the line of action of the tip circles, where the edge of the chamfer is off it."""
    height = 0.5e-3
    gears = make(tip_chamfer=height)
    shorter = cut_off(make(), height)
    beyond = np.array([1e-6, 0.05e-3, 0.2e-3, 0.5e-3, 0.9e-3])
    if side == "exit":
        roll_1 = gears.pinion.tip_form_roll_length + beyond
    else:
        roll_1 = gears.active_path.start - beyond
    wanted = corner_contact(shorter, side, beyond)
    assert np.all(wanted.valid)
    plain = conjugate_touch(gears, roll_1[:, None], gears.mating_roll_length(roll_1)[:, None], corners=True)
    assert np.all(plain.gap == 0.0)
    found = modified_touch(gears, plain, np.zeros(1), (Removed(),))
    assert found.gap[:, 0] == pytest.approx(wanted.gap, rel=2e-3, abs=1e-12)
    at = found.s_1 if side == "exit" else found.s_2
    gear = gears.pinion if side == "exit" else gears.wheel
    assert at[:, 0] == pytest.approx(float(gear.flank_coordinate(gear.tip_form_roll_length)), abs=1e-12)
    left = found.slope[:, 0]
    opening = np.abs(left) if side == "exit" else left + found.jump[:, 0, -1]
    assert opening == pytest.approx(wanted.slope_angle, rel=0.08, abs=2e-4)


def cut_off(gears, height):
    shorter = [
        replace(gear, tip_diameter=2.0 * (gear.tip_radius - gear.sign * height))
        for gear in (gears.pinion, gears.wheel)
    ]
    return replace(gears, pinion=shorter[0], wheel=shorter[1])


@pytest.mark.parametrize("make", [pair, ring_pair])
@pytest.mark.parametrize("edge", [{"tip_rounding": 0.2e-3}, {"tip_rounding": 1e-6}, {"tip_chamfer": 0.2e-3}])
def test_a_cut_tip_against_a_direct_search(make, edge):
    """The least of exact gap of the plain flanks and material removed, on the arc or at its beginning."""
    gears = make(**edge)
    beyond = np.array([0.05e-3, 0.1e-3, 0.3e-3])
    roll_1 = gears.pinion.tip_form_roll_length + beyond
    inside = roll_1 <= gears.pinion.tip_roll_length
    _, found = touches_at(gears, roll_1)
    tip = float(gears.pinion.flank_coordinate(gears.pinion.tip_roll_length))
    form = float(gears.pinion.flank_coordinate(gears.pinion.tip_form_roll_length))
    for k in np.flatnonzero(inside):
        s = np.linspace(form - 1e-5, min(tip, form + 0.1e-3), 200_001)
        roll = np.sqrt(2.0 * gears.pinion.base_radius * s)
        removed = gears.pinion.modification.material_removed(gears.pinion, roll)
        gap = edge_gap(gears, "exit", roll, roll_1[k]) + removed
        assert found.gap[k, 0] == pytest.approx(float(np.nanmin(gap)), rel=2e-3, abs=2e-12)
        assert found.s_1[k, 0] == pytest.approx(float(s[np.nanargmin(gap)]), abs=1e-6)


def touches_at(gears, roll_1):
    plain = conjugate_touch(gears, roll_1[:, None], gears.mating_roll_length(roll_1)[:, None], corners=True)
    return plain, modified_touch(gears, plain, np.zeros(1), (Removed(),))


@pytest.mark.parametrize("make", [pair, ring_pair])
@pytest.mark.parametrize("edge", [{"tip_rounding": 0.3e-3}, {"tip_chamfer": 0.3e-3}])
def test_touching_points_run_over_a_cut_tip_without_a_jump(make, edge):
    gears = make(**edge)
    ends = gears.active_path.start - 0.8e-3, gears.active_path.end + 0.8e-3
    plain, found = touches_at(gears, np.linspace(*ends, 6001))
    possible = np.isfinite(found.gap[:, 0])
    gap = found.gap[possible, 0]
    assert np.abs(np.diff(gap)).max() < 0.25e-6
    assert np.abs(np.diff(gap, 2)).max() < 2e-9
    assert np.all(gap >= -1e-15)
    within = np.abs(plain.roll_1 - np.mean(ends)) < 0.5 * (gears.active_path.length - 1e-9)
    assert np.all(np.abs(found.gap[within]) < 1e-15)
    assert np.abs(np.diff(found.s_1[possible, 0])).max() < 5e-6


def test_roundings_tend_to_the_sharp_edge():
    """Gap and place of a rounded edge approach those of a sharp one in proportion to its radius."""
    sharp = pair()
    roll_1 = sharp.pinion.tip_roll_length + np.linspace(0.02e-3, 0.8e-3, 14)
    plain, _ = touches_at(sharp, roll_1)
    for radius in (1e-5, 1e-7, 1e-9):
        _, found = touches_at(pair(tip_rounding=radius), roll_1)
        for name, limit in (("gap", 0.2 * radius), ("s_1", 2.0 * radius)):
            assert getattr(found, name) == pytest.approx(getattr(plain, name), abs=limit), name


def test_every_tip_edge_that_may_meet_a_flank_is_a_candidate_however_far_it_is():
    """Loads decide which edges touch: an overloaded tooth deflects by most of a module."""
    gears, position = pair(), np.linspace(-1.9, 1.9, 401)
    roll_1, roll_2 = gears.roll_lengths(position[:, None])
    touch = conjugate_touch(gears, roll_1, roll_2, corners=True)
    overshoot = (roll_1 - gears.path_of_contact.end).ravel()
    corner = corner_contact(gears, "exit", np.maximum(overshoot, 0.0))
    beyond = (overshoot > 0.0) & corner.valid
    assert np.ptp(corner.gap[beyond]) > 0.5 * gears.pinion.normal_module
    assert np.array_equal(touch.gap.ravel()[beyond], corner.gap[beyond])
