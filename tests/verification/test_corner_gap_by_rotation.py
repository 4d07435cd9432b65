"""Corner contact against brute force: exact profiles in place, the driven gear turned until they touch.

Gear 1's center is at the origin, its tooth up, seen so that its right flank is the loaded one. An external
wheel's tooth points down from a center on +y; a ring's stands on +y of a center on -y and points down too, so
that its loaded flank is the left one here.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from fe_contact import FlankModification, Gear, GearPair, InternalGearPair, RingGear
from fe_contact.contact.plain_touch import conjugate_touch
from fe_contact.contact.touch import modified_touch
from fe_contact.effects.flank_modification import ModificationGap
from fe_contact.geometry import ParallelAxes, Side, Toothing, corner_contact, tooth_profile


def gear(teeth: int, **fields: Any) -> Gear:
    defaults: dict[str, Any] = {"normal_module": 4e-3, "face_width": 25e-3, "bore_diameter": 5e-3}
    return Gear(teeth=teeth, **(defaults | fields))


def ring(teeth: int, **fields: Any) -> RingGear:
    size = {"normal_module": 4e-3, "face_width": 25e-3, "rim_diameter": 5e-3 * teeth}
    return RingGear(teeth=teeth, **(size | fields))


PAIRS: dict[str, ParallelAxes] = {
    "20/20": GearPair(gear(20), gear(20)),
    "17/43 shifted": GearPair(
        gear(17, profile_shift_coefficient=0.4), gear(43, profile_shift_coefficient=0.2), 0.1225
    ),
    "43/17 shifted": GearPair(
        gear(43, profile_shift_coefficient=0.2), gear(17, profile_shift_coefficient=0.4), 0.1225
    ),
    "40/80": GearPair(gear(40), gear(80)),
    "25/31 helical": GearPair(gear(25, helix_angle=0.35), gear(31, helix_angle=-0.35)),
    "36/96 internal": InternalGearPair(gear(36), ring(96, addendum_coefficient=0.9)),
    "19/60 internal shifted": InternalGearPair(
        gear(19, profile_shift_coefficient=0.4), ring(60, profile_shift_coefficient=-0.6), 0.0814
    ),
    "24/70 internal helical": InternalGearPair(
        gear(24, helix_angle=0.3, profile_shift_coefficient=0.2),
        ring(70, helix_angle=0.3, addendum_coefficient=0.8, profile_shift_coefficient=-0.1),
    ),
}


class Assembly:
    """Both loaded flanks in one plane."""

    def __init__(self, pair: ParallelAxes) -> None:
        self.pair, self.sign = pair, pair.wheel.sign
        self.up = np.array([0.0, self.sign * pair.center_distance])
        self.flanks = tuple(_sampled_flank(each) for each in (pair.pinion, pair.wheel))
        first, second = (np.array([radius]) for radius in pair.operating_pitch_radii)
        self.start = -_polar_angle(pair.pinion, first)[0], _polar_angle(pair.wheel, second)[0]

    def turns(self, roll_length: float, lag: float) -> tuple[float, float]:
        """Turns of both gears: clockwise, but counter-clockwise of an external gear 2."""
        rolled = roll_length - self.pair.path_of_contact.pitch_point
        first = self.start[0] + rolled / self.pair.pinion.base_radius
        return first, self.start[1] + (rolled - lag) / self.pair.wheel.base_radius

    def clearance(self, roll_length: float, lag: float) -> float:
        """Smallest clearance (arc in m) of all flank points, each against the other flank at its radius."""
        first, second = self.turns(roll_length, lag)
        on_first = _clockwise(self.flanks[0], first)
        on_second = self.placed(self.flanks[1], second) + self.up
        against_second = _angle_past(self.own_frame(on_first - self.up, second), self.pair.wheel, 0.0)
        against_first = _angle_past(on_second, self.pair.pinion, first)
        return min(against_first, against_second)

    def placed(self, vectors: np.ndarray, second: float) -> np.ndarray:
        """Vectors of gear 2's tooth frame as they stand at its turn `second`."""
        if self.sign > 0:
            return _clockwise(vectors, math.pi - second)
        return _clockwise(vectors * [-1.0, 1.0], second)

    def own_frame(self, vectors: np.ndarray, second: float) -> np.ndarray:
        """The way back."""
        if self.sign > 0:
            return _clockwise(vectors, second - math.pi)
        return _clockwise(vectors, -second) * [-1.0, 1.0]


def _sampled_flank(each: Toothing) -> np.ndarray:
    roll = np.linspace(each.form_roll_length, each.tip_roll_length, 41)
    return tooth_profile(each).flank(each.sign * roll**2 / (2.0 * each.base_radius))


def _clockwise(points: np.ndarray, angle: float) -> np.ndarray:
    sine, cosine = math.sin(angle), math.cos(angle)
    return points @ np.array([[cosine, -sine], [sine, cosine]])


def _polar_angle(each: Toothing, radius: np.ndarray) -> np.ndarray:
    """Angle from the tooth's center line at which the flank has a radius, by bisection on the profile."""
    profile = tooth_profile(each)
    low, high = np.full(radius.shape, profile.s_form), np.full(radius.shape, profile.s_tip)
    for _ in range(50):
        middle = 0.5 * (low + high)
        below = each.sign * (np.hypot(*profile.flank(middle).T) - radius) < 0.0
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    x, y = profile.flank(0.5 * (low + high)).T
    return np.arctan2(x, y)


def _angle_past(points: np.ndarray, each: Toothing, turn: float) -> float:
    radius = np.hypot(*points.T)
    within = each.sign * (radius - each.form_radius) >= 0.0
    within &= each.sign * (radius - each.tip_radius) <= 0.0
    if not np.any(within):
        return 1.0
    x, y = points[within].T
    past = np.arctan2(x, y) - turn - _polar_angle(each, radius[within])
    past = (past + math.pi) % (2.0 * math.pi) - math.pi
    return float(np.min(past * radius[within]))


def _overshoots(pair: ParallelAxes, side: Side) -> np.ndarray:
    """Four overshoots up to where the edge leaves the flank."""
    candidates = np.linspace(0.0, 0.02, 2001)
    limit = candidates[corner_contact(pair, side, candidates).valid][-1]
    return np.array([0.002, 0.1, 0.5, 0.99]) * limit


@pytest.mark.drawn
@pytest.mark.parametrize("side", ["approach", "exit"])
@pytest.mark.parametrize("name", PAIRS)
def test_gap_is_the_lag_that_makes_rigid_flanks_touch(name, side, record_figure):
    pair = PAIRS[name]
    assembly, path = Assembly(pair), pair.path_of_contact
    over = _overshoots(pair, side)
    roll = path.end + over if side == "exit" else path.start - over
    gap = corner_contact(pair, side, over).gap
    turned = [brentq(lambda lag, at=at: assembly.clearance(at, lag), -1e-4, 6e-3, xtol=1e-13) for at in roll]
    worst = float(np.max(np.abs(gap - turned)))
    record_figure(
        f"corner gap {side} {name}", worst, "at most 1e-12 m", "m", "rigid rotation of exact profiles"
    )
    assert worst < 1e-12


@pytest.mark.parametrize("side", ["approach", "exit"])
@pytest.mark.parametrize("name", PAIRS)
def test_touching_point_slope_and_lever_arms_are_those_of_the_placed_gears(name, side):
    pair = PAIRS[name]
    assembly, path = Assembly(pair), pair.path_of_contact
    for over in _overshoots(pair, side):
        state = corner_contact(pair, side, over)
        roll = (path.end if side == "exit" else path.start) + (over if side == "exit" else -over)
        first, second = assembly.turns(float(roll), float(state.gap))
        rolls = [pair.pinion.tip_roll_length, float(state.flank_roll_length)]
        if side == "approach":
            rolls = [float(state.flank_roll_length), pair.wheel.tip_roll_length]
        profiles = tooth_profile(pair.pinion), tooth_profile(pair.wheel)
        s = [
            each.gear.sign * 0.5 * length**2 / each.gear.base_radius
            for length, each in zip(rolls, profiles, strict=True)
        ]
        point = _clockwise(profiles[0].flank([s[0]]), first)[0]
        mate = assembly.placed(profiles[1].flank([s[1]]), second)[0] + assembly.up
        assert mate == pytest.approx(point, abs=1e-12)
        normals = (
            _clockwise(profiles[0].normal([s[0]]), first)[0],
            -assembly.placed(profiles[1].normal([s[1]]), second)[0],
        )
        cross = normals[0][0] * normals[1][1] - normals[0][1] * normals[1][0]
        assert abs(math.asin(cross)) == pytest.approx(float(state.slope_angle), abs=1e-9)
        force = normals[1] if side == "exit" else normals[0]  # along the mating flank's normal
        arm_1 = abs(point[0] * force[1] - point[1] * force[0]) / pair.pinion.base_radius
        from_2 = point - assembly.up
        arm_2 = abs(from_2[0] * force[1] - from_2[1] * force[0]) / pair.wheel.base_radius
        assert arm_1 == pytest.approx(float(state.lever_arm_ratio_pinion), abs=1e-9)
        assert arm_2 == pytest.approx(float(state.lever_arm_ratio_wheel), abs=1e-9)


@pytest.mark.parametrize("name", PAIRS)
def test_conjugate_flanks_touch_without_gap_inside_the_path(name):
    pair = PAIRS[name]
    assembly, path = Assembly(pair), pair.path_of_contact
    for roll in np.linspace(path.start, path.end, 7)[1:-1]:
        # sampled flanks stand clear by the sagitta of their spacing at most
        assert assembly.clearance(float(roll), 0.0) == pytest.approx(0.0, abs=1e-5)
        assert assembly.clearance(float(roll), 2e-5) < 0.0


def relieved(pair: ParallelAxes) -> ParallelAxes:
    """The pair with tip relief on its wheel."""
    relief = FlankModification(tip_relief=20e-6, tip_relief_length=2.5e-3)
    return replace(pair, wheel=replace(pair.wheel, modification=relief))


@pytest.mark.law
@pytest.mark.parametrize(
    "name",
    ["20/20", pytest.param("36/96 internal", marks=pytest.mark.nightly), "24/70 internal helical"],
)
def test_gap_of_a_relieved_wheel_is_the_lag_that_makes_its_flank_touch(name, record_figure):
    """The wheel's flank, moved along its normals by the relief, against the plain pinion.

    A slope m' moves the touching point off the line of action and turns the normal: the lever arm of the
    wheel is less by l m'/r_b, here half a per cent.
    """
    pair = relieved(PAIRS[name])
    wheel, assembly, path = pair.wheel, Assembly(pair), pair.path_of_contact
    roll_1 = np.linspace(path.start + 1e-3, path.start + 4e-3, 5)[None]
    touch = conjugate_touch(pair, roll_1, pair.mating_roll_length(roll_1), corners=False)
    term = ModificationGap(FlankModification(), wheel.modification)
    gap = modified_touch(pair, touch, np.zeros(5), (term,)).gap[0]
    roll_2 = np.linspace(wheel.form_roll_length, wheel.tip_roll_length, 20001)
    profile, s = tooth_profile(wheel), wheel.sign * roll_2**2 / (2.0 * wheel.base_radius)
    removed = wheel.modification.material_removed(wheel, roll_2)
    points = profile.flank(s) - removed[:, None] * profile.normal(s)

    def clearance(lag, roll):
        first, second = assembly.turns(roll, lag)
        return _angle_past(assembly.placed(points, second) + assembly.up, pair.pinion, first)

    turned = [brentq(clearance, -1e-6, 3e-5, args=(float(roll),), xtol=1e-12) for roll in roll_1[0]]
    off = gap - turned
    record_figure(f"gap of a relieved wheel {name}", np.ptp(off), "at most 1e-9 m", "m", "rigid rotation")
    assert np.ptp(off) < 1e-9
    assert np.abs(off).max() < (1.5e-8 if pair.internal else 2e-9)  # flanks are parabolas over 0.15 mm
    assert np.ptp(gap) > 5e-6


DEPTH = 20e-6


class Offset:
    """The same depth removed from one flank everywhere."""

    along_profile, only_removes = True, True
    grids = None, None

    def breaks(self, pair: ParallelAxes, face: np.ndarray) -> tuple[()]:
        return ()

    def __call__(self, pair: ParallelAxes, first: np.ndarray, second: np.ndarray, face: np.ndarray) -> Any:
        return np.full(np.broadcast(first, face).shape, DEPTH)


RELIEF = FlankModification(tip_relief=DEPTH, tip_relief_length=4e-3)


@pytest.mark.law
@pytest.mark.parametrize("sloped", [False, True])
@pytest.mark.parametrize("side", ["approach", "exit"])
@pytest.mark.parametrize("name", ["20/20", "17/43 shifted", "43/17 shifted", "36/96 internal"])
def test_gap_of_a_relieved_tip_edge_is_the_lag_that_makes_it_touch(name, side, sloped, record_figure):
    """The edge is the end of the relieved flank, moved along its normal; the mate is a plain involute.

    A lag closes what is removed from gear 2 by the lever arm of its edge, up to two per cent less than on
    the line of action.
    """
    pair, gear = PAIRS[name], int(side == "approach")
    body, path = (pair.pinion, pair.wheel)[gear], pair.path_of_contact
    reach = np.linspace(0.0, 2e-3, 401)[1:]
    overshoot = np.interp([5e-6, 15e-6, 40e-6], corner_contact(pair, side, reach).gap, reach)
    roll_1 = (path.start - overshoot if side == "approach" else path.end + overshoot)[None]
    touch = conjugate_touch(pair, roll_1, pair.mating_roll_length(roll_1), corners=True)
    relief, plain = RELIEF if sloped else FlankModification(), FlankModification()
    term = ModificationGap(*((plain, relief) if gear else (relief, plain))) if sloped else Offset()
    gap = modified_touch(pair, touch, np.zeros(overshoot.size), (term,)).gap[0]
    roll = body.tip_roll_length - body.sign * np.concatenate([[0.0], np.geomspace(1e-7, 2e-3, 4001)])
    profile, s = tooth_profile(body), body.sign * roll**2 / (2.0 * body.base_radius)
    removed = relief.material_removed(body, roll) if sloped else np.full(roll.shape, DEPTH)
    points, assembly = profile.flank(s) - removed[:, None] * profile.normal(s), Assembly(pair)

    def clearance(lag, at):
        first, second = assembly.turns(at, lag)
        if gear:
            return _angle_past(assembly.placed(points, second) + assembly.up, pair.pinion, first)
        placed = assembly.own_frame(_clockwise(points, first) - assembly.up, second)
        return _angle_past(placed, pair.wheel, 0.0)

    turned = [
        brentq(clearance, lag - 5e-6, lag + 5e-6, args=(float(at),), xtol=1e-13)
        for lag, at in zip(gap, roll_1[0], strict=True)
    ]
    worst = float(np.max(np.abs(gap - turned)))
    record_figure(f"gap of a relieved edge {name} {side} {sloped}", worst, "at most 2e-8 m", "m", "rotation")
    assert worst < 2e-8
