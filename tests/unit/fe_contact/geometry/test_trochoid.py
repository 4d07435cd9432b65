"""The fillet is what the tool leaves: rolled past it, the tool touches every fillet point and cuts none."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fe_contact.geometry import Gear, tooth_profile

CASES: list[dict[str, Any]] = [
    {"teeth": 20},
    {"teeth": 9},  # undercut
    {"teeth": 200, "profile_shift_coefficient": -0.4},
    {"teeth": 43, "profile_shift_coefficient": 0.6, "root_radius_coefficient": 0.2},
    {"teeth": 25, "helix_angle": math.radians(30.0)},
    {"teeth": 12, "helix_angle": math.radians(-26.0), "root_radius_coefficient": 0.45},
    {"teeth": 11, "root_radius_coefficient": 0.0},  # sharp tool, undercut
    {"teeth": 24, "thickness_allowance": 1e-4},
    {
        "teeth": 15,
        "profile_shift_coefficient": 1.1,
        "addendum_coefficient": 0.4,
        "root_radius_coefficient": 0.4,
    },
]
NAMES = [" ".join(f"{key}={value:.3g}" for key, value in case.items()) for case in CASES]
cases = pytest.mark.parametrize("fields", CASES, ids=NAMES)


def clearance_to_tool_rounding(gear: Gear, point: np.ndarray) -> float:
    """Smallest distance of a point of the gear to the tool's rounding while the gear rolls past the tool.

    From the definition: the gear turns by phi, its reference circle rolling on the tool's pitch line; the
    rounding is a circle in the normal plane, where distances along the pitch line shrink by cos(beta).
    """
    rho, reference = gear.root_radius_coefficient * gear.normal_module, gear.reference_radius
    alpha, beta = gear.normal_pressure_angle, gear.helix_angle
    depth = gear.normal_module * (gear.dedendum_coefficient - gear.profile_shift_coefficient)
    half_tooth = 0.5 * gear.tooth_thickness * math.cos(beta)
    center_x = half_tooth + (depth - rho) * math.tan(alpha) + rho / math.cos(alpha)

    def distance(turn: Any) -> Any:
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
def test_tool_touches_every_fillet_point(make_gear: Callable[..., Gear], fields: dict[str, Any]) -> None:
    gear = make_gear(**fields)
    profile = tooth_profile(gear)
    points = profile.fillet(np.linspace(0.0, profile.fillet_length, 9))
    clearance = [clearance_to_tool_rounding(gear, point) for point in points]
    assert clearance == pytest.approx(np.zeros(9), abs=1e-11)


@cases
def test_tool_cuts_nothing_of_the_involute_above_the_form_point(
    make_gear: Callable[..., Gear], fields: dict[str, Any]
) -> None:
    gear = make_gear(**fields)
    points = tooth_profile(gear).involute(np.linspace(gear.form_roll_length, gear.tip_roll_length, 9))
    assert min(clearance_to_tool_rounding(gear, point) for point in points) >= -1e-11


def test_undercut_removes_the_involute_below_the_form_point(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear(teeth=9)
    below = tooth_profile(gear).involute(np.array([0.5 * gear.form_roll_length]))[0]
    assert clearance_to_tool_rounding(gear, below) < -1e-5


@cases
def test_radius_falls_from_flank_to_root_circle(
    make_gear: Callable[..., Gear], fields: dict[str, Any]
) -> None:
    gear = make_gear(**fields)
    radius = gear.trochoid.radius(np.linspace(gear.form_point.tool_angle, 0.5 * math.pi, 100))
    assert np.all(np.diff(radius) < 0.0)
    assert radius[0] == pytest.approx(gear.form_radius, rel=1e-13)
    assert radius[-1] == pytest.approx(gear.root_radius, rel=1e-13)


@cases
def test_arc_length_and_its_inverse_agree(make_gear: Callable[..., Gear], fields: dict[str, Any]) -> None:
    gear = make_gear(**fields)
    start, trochoid = gear.form_point.tool_angle, gear.trochoid
    angle = np.linspace(start, 0.5 * math.pi, 50)
    arc = trochoid.arc_length(start, angle)
    assert trochoid.angle_at_arc(start, arc) == pytest.approx(angle, rel=1e-12)
    # against the chord sum, whose error falls with the square of the step
    fine = trochoid.point(np.linspace(start, 0.5 * math.pi, 20001))
    assert arc[-1] == pytest.approx(np.sum(np.hypot(*np.diff(fine, axis=0).T)), rel=1e-8)


def test_polar_angle_and_radius_are_the_points(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear(teeth=17, helix_angle=0.3)
    angle = np.linspace(gear.normal_pressure_angle, 0.5 * math.pi, 20)
    x, y = gear.trochoid.point(angle).T
    assert np.arctan2(x, y) == pytest.approx(gear.trochoid.polar_angle(angle), rel=1e-13)
    assert np.hypot(x, y) == pytest.approx(gear.trochoid.radius(angle), rel=1e-13)
