"""The laws of reliefs and of rounded and chamfered tips: their ends, tangency, means, sides, corners."""

import math
from dataclasses import replace
from typing import Any, get_args

import numpy as np
import pytest
from scipy.integrate import quad
from spur_gears import make_gear

from bounds import at_most
from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.flank.relief_shape import SHAPES, Shape
from fe_contact.geometry import FlankModification, Gear, GearPair, InternalGearPair, RingGear, tooth_profile
from fe_contact.geometry.toothing import Toothing

BY_SHAPE = pytest.mark.parametrize("shape", SHAPES)
MEAN = {  # of the depth over the length
    "linear": 1.0 / 2.0,
    "parabolic": 1.0 / 3.0,
    "exponential": (math.e - 2.0) / (math.e - 1.0),
    "logarithmic": 1.0 / (math.e - 1.0),
}


def test_the_shapes_are_those_of_the_exchange_format():
    assert tuple(SHAPES) == get_args(Shape)
    assert sorted(SHAPES) == ["circular", "exponential", "linear", "logarithmic", "parabolic"]
    u = np.linspace(0.0, 1.0, 21)
    there_and_back = SHAPES["logarithmic"](SHAPES["exponential"](u, 0.01), 0.01)
    assert there_and_back == pytest.approx(u, abs=1e-15)
    facts: dict[str, Any] = {"end_relief_length": 1e-5, "end_relief_shape": "circular"}
    FlankModification(end_relief=1e-5, **facts)
    with pytest.raises(InputError) as caught:
        FlankModification(end_relief=1.001e-5, **facts)
    assert (caught.value.field, caught.value.bound) == (
        "end_relief",
        at_most(1e-5, "m", "the length of the arc"),
    )


@BY_SHAPE
@pytest.mark.parametrize("ratio", [1e-6, 0.01, 0.5])
def test_a_shape_rises_from_nothing_to_its_amount_as_its_derivatives_say(shape, ratio):
    law, u = SHAPES[shape], np.linspace(-0.5, 1.5, 401)
    depth = law(u, ratio)
    assert np.all(depth[u <= 0.0] == 0.0)
    assert depth[u >= 1.0] == pytest.approx(1.0, rel=1e-14)
    assert np.all(np.diff(depth[(u >= 0.0) & (u <= 1.0)]) > 0.0)
    step = 1e-3
    first, second = law(np.array([step, 2.0 * step]), ratio)
    assert (4.0 * first - second) / (2.0 * step) == pytest.approx(law.slope, abs=1e-5)
    assert (second - 2.0 * first) / step**2 == pytest.approx(law.bend(ratio), rel=1e-2, abs=1e-8)
    assert (law.slope == 0.0) == (shape in ("parabolic", "circular"))


@pytest.mark.parametrize(("shape", "mean"), MEAN.items())
def test_the_mean_of_a_shape_is_its_integral(shape, mean):
    found, _ = quad(lambda u: float(SHAPES[shape](np.array(u), 0.01)), 0.0, 1.0, epsabs=1e-14)
    assert found == pytest.approx(mean, rel=1e-12)


@pytest.mark.parametrize("ratio", [1e-3, 0.2, 1.0])
def test_a_circular_relief_is_an_arc_that_touches_where_it_starts(ratio):
    u = np.linspace(0.0, 1.0, 11)
    radius = (1.0 + ratio**2) / (2.0 * ratio)  # lengths
    depth = ratio * SHAPES["circular"](u, ratio)
    assert u**2 + (depth - radius) ** 2 == pytest.approx(np.full(11, radius**2), rel=1e-13)


def helical(hand: int = 1, **modification: Any) -> Gear:
    return make_gear(helix_angle=hand * 0.3, modification=FlankModification(**modification))


def removed(gear: Gear, roll: np.ndarray, face: np.ndarray) -> np.ndarray:
    return gear.modification.material_removed(gear, roll, face)


@BY_SHAPE
def test_a_relief_begins_with_the_slope_and_the_curvature_it_states(shape):
    gear = helical(

        tip_relief=20e-6, tip_relief_length=1.5e-3, tip_relief_shape=shape,
        root_relief=9e-6, root_relief_length=0.8e-3, root_relief_shape=shape,
        triangular_tip_relief=12e-6, triangular_tip_relief_length=1.8e-3, triangular_tip_relief_shape=shape,
    )  # fmt: skip
    face = np.array([12.4e-3])
    for part in gear.modification.parts:
        for start in part.relief_starts(gear, face) if part.varies else ():
            s = np.square(start.roll_length) / (2.0 * gear.base_radius)
            d = 4e-6 * np.array([1.0, 2.0])
            roll = np.sqrt(2.0 * gear.base_radius * (s + (1.0 if start.towards_tip else -1.0) * d))
            first, second = part.removed(gear, roll, np.broadcast_to(face, 2))
            assert (4.0 * first - second) / (2.0 * d[0]) == pytest.approx(start.jump, rel=1e-4, abs=1e-6)
            assert (second - 2.0 * first) / d[0] ** 2 == pytest.approx(start.bend, rel=2e-2)


@BY_SHAPE
def test_end_reliefs_of_both_faces_are_the_symmetric_one(shape):
    gear, face = make_gear(), np.linspace(-12.5e-3, 12.5e-3, 51)
    one = {"end_relief": 12e-6, "end_relief_length": 4e-3, "end_relief_shape": shape}
    datum = {key.replace("relief", "relief_datum_face"): value for key, value in one.items()}
    other = {key.replace("relief", "relief_non_datum_face"): value for key, value in one.items()}
    both, first, second = (
        FlankModification(**facts).material_removed(gear, 0.012, face) for facts in (one, datum, other)
    )
    assert (first + second).tobytes() == both.tobytes()
    assert first[0] == second[-1] == pytest.approx(12e-6, rel=1e-12)
    assert not np.any(first[face > 0.0]) and not np.any(second[face < 0.0])


def test_crownings_of_sides_meet_in_one_highest_point():
    gear = make_gear()
    middle = 0.5 * (gear.form_roll_length + gear.tip_roll_length)
    radius = math.hypot(gear.base_radius, middle)
    profile = FlankModification(
        profile_crowning_tip=6e-6,
        profile_crowning_tip_length=gear.tip_radius - radius,
        profile_crowning_root=6e-6,
        profile_crowning_root_length=radius - gear.form_radius,
    )
    roll = np.linspace(gear.form_roll_length, gear.tip_roll_length, 41)
    expected = FlankModification(profile_crowning=6e-6).material_removed(gear, roll)
    assert profile.material_removed(gear, roll) == pytest.approx(expected, abs=1e-17)
    half = 0.5 * gear.face_width
    helix = FlankModification(
        helix_crowning_datum_face=4e-6, helix_crowning_datum_face_length=half,
        helix_crowning_non_datum_face=4e-6, helix_crowning_non_datum_face_length=half,
    )  # fmt: skip
    face = np.linspace(-half, half, 41)
    expected = FlankModification(helix_crowning=4e-6).material_removed(gear, 0.012, face)
    assert helix.material_removed(gear, 0.012, face) == pytest.approx(expected, abs=1e-20)
    lead = FlankModification(
        helix_crowning_datum_face=3e-6, helix_crowning_datum_face_length=20e-3,
        helix_crowning_non_datum_face=8e-6, helix_crowning_non_datum_face_length=5e-3,
    )  # fmt: skip
    face = np.array([-12.5e-3, -2.5e-3, 7.5e-3, 10.0e-3, 12.5e-3])
    found = lead.material_removed(gear, 0.012, face)
    assert found == pytest.approx([3e-6, 0.75e-6, 0.0, 2e-6, 8e-6], abs=1e-18)


SIDES = {
    "end_relief_datum_face": 9e-6, "end_relief_datum_face_length": 3e-3,
    "end_relief_datum_face_shape": "logarithmic",
    "helix_crowning_non_datum_face": 4e-6, "helix_crowning_non_datum_face_length": 15e-3,
}  # fmt: skip


def test_a_flank_seen_in_a_mirror_has_its_faces_and_its_hand_exchanged():
    """Mirrored at mid-face, datum and non-datum face change places, and right hand becomes left."""
    corners = {"triangular_tip_relief": 7e-6, "triangular_root_relief": 5e-6}
    corners |= {f"{name}_length": 1.2e-3 for name in corners}
    mark = {"_non_datum_": "_datum_", "_datum_": "_non_datum_"}
    mirrored = {
        key.replace(side, mark[side]): value
        for key, value in SIDES.items()
        for side in ["_non_datum_" if "_non_datum_" in key else "_datum_"]
    }
    gear, image = helical(1, **SIDES, **corners), helical(-1, **mirrored, **corners)
    roll = np.linspace(gear.form_roll_length, gear.tip_roll_length, 31)[:, None]
    face = np.linspace(-12.5e-3, 12.5e-3, 21)
    assert removed(gear, roll, face) == pytest.approx(removed(image, roll, -face), abs=1e-20)
    assert np.abs(removed(gear, roll, face) - removed(gear, roll, -face)).max() > 5e-6


@BY_SHAPE
@pytest.mark.parametrize("end", ["tip", "root"])
def test_a_triangular_relief_is_a_relief_along_lines_of_contact(shape, end):
    """At its corner's end of the face it is the tip or root relief of the same figures."""
    facts = {"": 15e-6, "_length": 1.2e-3 if end == "tip" else 0.8e-3, "_shape": shape}
    gear = helical(**{f"triangular_{end}_relief{key}": value for key, value in facts.items()})
    plain = FlankModification(**{f"{end}_relief{key}": value for key, value in facts.items()})
    corner = 12.5e-3 if end == "tip" else -12.5e-3  # of a right-hand gear
    roll = np.linspace(gear.form_roll_length, gear.tip_roll_length, 41)
    at_corner = removed(gear, roll, np.full(41, corner))
    assert at_corner == pytest.approx(plain.material_removed(gear, roll), abs=1e-20)
    assert not np.any(removed(gear, roll, np.full(41, -corner)))
    face = np.linspace(-12.5e-3, 12.5e-3, 2001)
    for line in (0.3, 0.6, 0.95):  # l + z tan(beta_b) from the corner's
        reach = gear.tip_roll_length if end == "tip" else gear.form_roll_length
        away = (line - 1.0) * 1e-3 * (1 if end == "tip" else -1)
        along = reach + away + (corner - face) * math.tan(gear.base_helix_angle)
        on = (along <= gear.tip_roll_length) & (along >= gear.form_roll_length)
        depth = removed(gear, along[on], face[on])
        assert on.sum() > 1 and depth.min() > 0.0
        assert depth == pytest.approx(np.full(on.sum(), depth[0]), rel=1e-10)


def pairs() -> list[GearPair | InternalGearPair]:
    own = dict.fromkeys(("triangular_tip_relief", "triangular_root_relief"), 1e-05)
    own |= {f"{name}_length": 1.6e-3 for name in own}
    shape: dict[str, Any] = {
        "normal_module": 3e-3,
        "face_width": 20e-3,
        "modification": FlankModification(**own),
    }
    found: list[GearPair | InternalGearPair] = []
    for hand in (0.25, -0.25):
        pinion = Gear(23, bore_diameter=20e-3, helix_angle=hand, **shape)
        found.append(GearPair(pinion, Gear(41, bore_diameter=20e-3, helix_angle=-hand, **shape)))
        ring = RingGear(71, rim_diameter=260e-3, addendum_coefficient=0.8, helix_angle=hand, **shape)
        found.append(InternalGearPair(pinion, ring))
    return found


@pytest.mark.parametrize("pair", pairs())
def test_on_either_gear_a_line_of_contact_is_relieved_all_along(pair):
    face = np.linspace(-10e-3, 10e-3, 41)
    for position in np.linspace(-1.6, 1.6, 33):
        first, _ = pair.roll_lengths(position)
        roll_1 = first - face * math.tan(pair.base_helix_angle)
        for gear, roll in ((pair.pinion, roll_1), (pair.wheel, pair.mating_roll_length(roll_1))):
            ends = sorted((gear.form_roll_length, gear.tip_roll_length))
            on = (roll >= ends[0]) & (roll <= ends[1])
            depth = gear.modification.material_removed(gear, roll[on], face[on])
            assert depth.size == 0 or np.ptp(depth) < 1e-18


RING = RingGear(60, 4e-3, 25e-3, rim_diameter=300e-3, addendum_coefficient=0.8)
KINDS = ("spur", "helical", "ring")


def gear_of(kind: str, **modification: float) -> Toothing:
    shape = FlankModification(**modification)
    if kind == "ring":
        return replace(RING, modification=shape)
    return make_gear(helix_angle=0.3 if kind == "helical" else 0.0, modification=shape)


def flank_and_inwards(gear: Toothing, s: float) -> tuple[np.ndarray, np.ndarray]:
    profile = tooth_profile(gear)
    return profile.flank(np.array(s)), -profile.normal(np.array(s))


@pytest.mark.parametrize("kind", KINDS)
def test_a_rounding_touches_the_involute_and_the_tip_circle(kind):
    """The circle about a center inside the tooth is tangent to both: its distances are the radius."""
    radius = 0.3e-3
    gear = gear_of(kind, tip_rounding=radius)
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
def test_a_chamfer_begins_at_its_height_and_runs_straight(kind):
    height, angle = 0.3e-3, math.radians(20.0)
    gear = gear_of(kind, tip_chamfer=height, tip_chamfer_angle=angle)
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
def test_what_is_removed_is_what_the_break_says(kind, edge):
    """To the last digits, so that nothing is left over beside it in the gap."""
    gear = gear_of(kind, **edge)
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


def test_no_edge_is_a_sharp_tip():
    none = FlankModification(tip_rounding=0.0, tip_chamfer=0.0, tip_chamfer_angle=1.0)
    gear = make_gear(modification=none)
    assert none.neutral
    assert none.relief_starts(gear) == ()
    assert gear.tip_form_radius == gear.tip_radius
    assert gear.tip_form_roll_length == gear.tip_roll_length
    pair = GearPair(gear, gear, 80e-3)
    assert pair.active_path == pair.path_of_contact
    assert pair.active_contact_ratio == pair.transverse_contact_ratio


def test_contact_ends_at_the_tip_form_circles():
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


def test_flanks_that_end_too_early_make_no_pair():
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
def test_the_largest_edge_that_is_named_is_accepted(kind):
    for field in ("tip_rounding", "tip_chamfer"):
        with pytest.raises(InputError) as caught:
            gear_of(kind, **{field: 20e-3})
        assert caught.value.field == f"modification.{field}"
        largest = float(str(caught.value.bound).rpartition(" ")[2])
        gear = gear_of(kind, **{field: largest})
        assert abs(gear.tip_form_radius - gear.form_radius) > 0.0
        with pytest.raises(InputError):
            gear_of(kind, **{field: 1.001 * largest})


@pytest.mark.parametrize("kind", ["spur", "helical"])
def test_a_chamfer_that_turns_back_from_the_tip_is_refused_by_its_angle(kind):
    with pytest.raises(InputError) as caught:
        gear_of(kind, tip_chamfer=0.1e-3, tip_chamfer_angle=math.radians(80.0))
    assert caught.value.field == "modification.tip_chamfer_angle"
    largest = float(str(caught.value.bound).rpartition(" ")[2])
    assert math.radians(50.0) < largest < math.radians(80.0)
    gear_of(kind, tip_chamfer=1e-6, tip_chamfer_angle=largest)
