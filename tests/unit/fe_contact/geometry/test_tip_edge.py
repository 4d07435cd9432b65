"""Rounded and chamfered tips: where the usable flank ends and what is missing beyond."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.geometry import FlankModification, Gear, GearPair, InternalGearPair, RingGear, tooth_profile
from fe_contact.geometry.toothing import Toothing

RING = RingGear(60, 4e-3, 25e-3, rim_diameter=300e-3, addendum_coefficient=0.8)
KINDS = ("spur", "helical", "ring")


def gear_of(kind: str, make_gear: Callable[..., Gear], **modification: float) -> Toothing:
    shape = FlankModification(**modification)
    if kind == "ring":
        return replace(RING, modification=shape)
    return make_gear(helix_angle=0.3 if kind == "helical" else 0.0, modification=shape)


def flank_and_inwards(gear: Toothing, s: float) -> tuple[np.ndarray, np.ndarray]:
    profile = tooth_profile(gear)
    return profile.flank(np.array(s)), -profile.normal(np.array(s))


@pytest.mark.parametrize("kind", KINDS)
def test_a_rounding_touches_the_involute_and_the_tip_circle(
    make_gear: Callable[..., Gear], kind: str
) -> None:
    """The circle about a center inside the tooth is tangent to both: its distances are the radius."""
    radius = 0.3e-3
    gear = gear_of(kind, make_gear, tip_rounding=radius)
    s_form = gear.sign * gear.tip_form_roll_length**2 / (2.0 * gear.base_radius)
    point, inwards = flank_and_inwards(gear, s_form)
    center = point + radius * inwards
    assert abs(gear.tip_radius - np.linalg.norm(center)) == pytest.approx(radius, rel=1e-10)
    assert np.linalg.norm(point) == pytest.approx(gear.tip_form_radius, rel=1e-13)
    # the involute leaves the circle by what is removed, along the normal there
    profile = tooth_profile(gear)
    for fraction in (0.05, 0.1, 0.2):
        s = s_form + fraction * radius
        at, inside = profile.flank(np.array(s)), -profile.normal(np.array(s))
        roll = math.sqrt(2.0 * gear.base_radius * abs(s))
        removed = float(gear.modification.material_removed(gear, roll))
        away = np.linalg.norm(at + removed * inside - center) - radius
        assert abs(away) < 0.6 * fraction**2 * removed


@pytest.mark.parametrize("kind", KINDS)
def test_a_chamfer_begins_at_its_height_and_runs_straight(make_gear: Callable[..., Gear], kind: str) -> None:
    height, angle = 0.3e-3, math.radians(20.0)
    gear = gear_of(kind, make_gear, tip_chamfer=height, tip_chamfer_angle=angle)
    assert abs(gear.tip_form_radius - gear.tip_radius) == pytest.approx(height, rel=1e-10)
    profile = tooth_profile(gear)
    s_form = gear.sign * gear.tip_form_roll_length**2 / (2.0 * gear.base_radius)
    start, inwards = flank_and_inwards(gear, s_form)
    upwards = gear.sign * np.array([inwards[1], -inwards[0]])
    for way in (0.02e-3, 0.1e-3):
        roll = math.sqrt(2.0 * gear.base_radius * abs(s_form + way))
        removed = float(gear.modification.material_removed(gear, roll))
        at = profile.flank(np.array(s_form + way)) + removed * inwards - start
        assert math.atan2(at @ inwards, at @ upwards) == pytest.approx(angle, abs=2e-4)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("edge", [{"tip_rounding": 0.2e-3}, {"tip_chamfer": 0.2e-3}])
def test_what_is_removed_is_what_the_break_says(
    make_gear: Callable[..., Gear], kind: str, edge: dict[str, float]
) -> None:
    """To the last digits, so that nothing is left over beside it in the gap."""
    gear = gear_of(kind, make_gear, **edge)
    (start,) = gear.modification.relief_starts(gear)
    assert start.towards_tip
    assert start.ends_flank
    assert start.roll_length == gear.tip_form_roll_length
    roll = np.linspace(start.roll_length, gear.tip_roll_length, 9)
    way = np.abs(roll**2 - start.roll_length**2) / (2.0 * gear.base_radius)
    removed = gear.modification.material_removed(gear, roll)
    assert removed == pytest.approx(way * (start.jump + 0.5 * start.bend * way), rel=1e-9, abs=1e-18)
    assert removed[-1] > 25e-6
    below = np.linspace(gear.form_roll_length, start.roll_length, 9)
    assert not np.any(gear.modification.material_removed(gear, below))


def test_no_edge_is_a_sharp_tip(make_gear: Callable[..., Gear]) -> None:
    none = FlankModification(tip_rounding=0.0, tip_chamfer=0.0, tip_chamfer_angle=1.0)
    gear = make_gear(modification=none)
    assert none.neutral
    assert none.relief_starts(gear) == ()
    assert gear.tip_form_radius == gear.tip_radius
    assert gear.tip_form_roll_length == gear.tip_roll_length
    pair = GearPair(gear, gear, 80e-3)
    assert pair.active_path == pair.path_of_contact
    assert pair.active_contact_ratio == pair.transverse_contact_ratio


def test_an_edge_is_along_the_profile_all_over_the_face() -> None:
    shape = FlankModification(tip_chamfer=1e-4, helix_crowning=1e-6)
    assert shape.along_profile == FlankModification(tip_chamfer=1e-4)
    assert shape.along_face == FlankModification(helix_crowning=1e-6)
    assert FlankModification(tip_rounding=1e-4).varies_along_profile
    assert not FlankModification(tip_rounding=1e-4).varies_along_face


def test_contact_ends_at_the_tip_form_circles(make_gear: Callable[..., Gear]) -> None:
    """As with tips cut off there: d_Na = d_Fa."""
    height = 0.3e-3
    chamfered = make_gear(modification=FlankModification(tip_chamfer=height))
    cut = make_gear(tip_diameter=2.0 * (chamfered.tip_radius - height))
    found, wanted = (GearPair(gear, gear, 80e-3) for gear in (chamfered, cut))
    assert found.active_contact_ratio == pytest.approx(wanted.transverse_contact_ratio, rel=1e-12)
    assert found.active_path.points == pytest.approx(wanted.path_of_contact.points, rel=1e-12)
    assert found.transverse_contact_ratio > found.active_contact_ratio + 0.09
    ring = replace(RING, modification=FlankModification(tip_chamfer=height))
    cut_ring = replace(RING, tip_diameter=2.0 * (RING.tip_radius + height))
    found, wanted = (InternalGearPair(make_gear(), wheel, 80e-3) for wheel in (ring, cut_ring))
    assert found.active_contact_ratio == pytest.approx(wanted.transverse_contact_ratio, rel=1e-12)


def test_flanks_that_end_too_early_make_no_pair(make_gear: Callable[..., Gear]) -> None:
    shape = FlankModification(tip_chamfer=1.8e-3, tip_chamfer_angle=math.radians(10.0))
    gear = make_gear(modification=shape)
    for pair, name in (((make_gear(), gear), "wheel"), ((gear, make_gear()), "pinion")):
        assert GearPair(*pair, 80e-3).active_contact_ratio > 1.0
        deeper = replace(shape, tip_chamfer=3.6e-3)
        with pytest.raises(InfeasibleGeometry, match="contact ratio") as caught:
            GearPair(*(replace(each, modification=deeper) if each is gear else each for each in pair), 80e-3)
        assert caught.value.field == f"{name}.modification.tip_chamfer"
    with pytest.raises(InfeasibleGeometry, match="between the tip form circles the contact ratio is"):
        GearPair(gear, gear, 80e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_the_largest_edge_that_is_named_is_accepted(make_gear: Callable[..., Gear], kind: str) -> None:
    for field in ("tip_rounding", "tip_chamfer"):
        with pytest.raises(InputError) as caught:
            gear_of(kind, make_gear, **{field: 20e-3})
        assert caught.value.field == f"modification.{field}"
        largest = float(str(caught.value.bound).rpartition(" ")[2])
        gear = gear_of(kind, make_gear, **{field: largest})
        assert abs(gear.tip_form_radius - gear.form_radius) > 0.0
        with pytest.raises(InputError):
            gear_of(kind, make_gear, **{field: 1.001 * largest})


@pytest.mark.parametrize("kind", ["spur", "helical"])
def test_a_chamfer_that_turns_back_from_the_tip_is_refused_by_its_angle(
    make_gear: Callable[..., Gear], kind: str
) -> None:
    with pytest.raises(InputError) as caught:
        gear_of(kind, make_gear, tip_chamfer=0.1e-3, tip_chamfer_angle=math.radians(80.0))
    assert caught.value.field == "modification.tip_chamfer_angle"
    largest = float(str(caught.value.bound).rpartition(" ")[2])
    assert math.radians(50.0) < largest < math.radians(80.0)
    gear_of(kind, make_gear, tip_chamfer=1e-6, tip_chamfer_angle=largest)


@pytest.mark.parametrize(
    ("fields", "named"),
    [
        ({"tip_rounding": -1e-4}, "tip_rounding"),
        ({"tip_rounding": math.nan}, "tip_rounding"),
        ({"tip_rounding": 0.3}, "tip_rounding"),
        ({"tip_chamfer": -1e-4}, "tip_chamfer"),
        ({"tip_chamfer": 1e-4, "tip_chamfer_angle": 0.0}, "tip_chamfer_angle"),
        ({"tip_chamfer": 1e-4, "tip_chamfer_angle": 45.0}, "tip_chamfer_angle"),
        ({"tip_chamfer": 1e-4, "tip_rounding": 1e-4}, "tip_chamfer"),
    ],
)
def test_bad_edges_are_refused(fields: dict[str, float], named: str) -> None:
    with pytest.raises(InputError) as caught:
        FlankModification(**fields)
    assert caught.value.field == named
