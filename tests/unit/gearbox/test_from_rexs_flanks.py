"""Which flank of a REXS gear carries, where its face coordinates lie, and what its modifications become."""

import itertools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from opened_unit import said
from rexs_stage import (
    PINION,
    PINION_LEFT,
    PINION_RIGHT,
    STAGE,
    WHEEL,
    WHEEL_LEFT,
    WHEEL_RIGHT,
    relation,
    stage_unit,
)

from fe_contact.geometry import Toothing
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.loaded_flank import LoadedFlank
from lineofaction.gearbox.from_rexs.meshing import Meshing
from lineofaction.gearbox.from_rexs.stage_case import StageCase
from lineofaction.gearbox.schemas import Case


def loaded(unit: GearUnit, gear: int, torque: float) -> LoadedFlank:
    meshing = Meshing.of(unit.part(STAGE), torques=(torque,))
    return LoadedFlank.of(meshing, unit.part(gear))


SIGNS = (1, -1)
DIRECTION = {1: "positive", -1: "negative"}


def side_by_vectors(sense: float, *, drives: bool, datum: int, ring: bool = False) -> str:
    """Return the loaded flank of a gear by where its tooth moves, seen from its datum face."""
    u, outwards = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    tip = -outwards if ring else outwards
    moves = sense * np.cross(u, outwards)
    right = np.cross(-datum * u, tip)  # of one who looks from the datum face, the tip upwards
    leading_is_right = bool(moves @ right > 0.0)
    return "right" if leading_is_right == drives else "left"


@pytest.mark.parametrize(("sense", "datum"), list(itertools.product(SIGNS, SIGNS)))
def test_a_driver_carries_on_its_leading_flank_a_driven_gear_on_its_trailing_one(sense, datum):
    orientation = {"datum_face_orientation": DIRECTION[datum]}
    external = stage_unit({PINION: orientation, WHEEL: orientation})
    driver = side_by_vectors(sense, drives=True, datum=datum)
    driven = side_by_vectors(-sense, drives=False, datum=datum)
    assert loaded(external, PINION, 10.0 * sense).side == driver
    assert loaded(external, WHEEL, 10.0 * sense).side == driven


@pytest.mark.parametrize(("sense", "datum"), list(itertools.product(SIGNS, SIGNS)))
def test_a_ring_gear_carries_on_its_trailing_flank_its_tooth_turned_upwards(sense, datum):
    unit = stage_unit({WHEEL: {"datum_face_orientation": DIRECTION[datum]}}, {WHEEL: "ring_gear"})
    expected = side_by_vectors(sense, drives=False, datum=datum, ring=True)
    assert loaded(unit, WHEEL, 10.0 * sense).side == expected
    # If the ring gear drives, it carries on its leading flank, and the planet on its trailing one.
    meshing = Meshing.of(unit.part(STAGE), driver=WHEEL, torques=(10.0 * sense,))
    ring = LoadedFlank.of(meshing, unit.part(WHEEL))
    planet = LoadedFlank.of(meshing, unit.part(PINION))
    assert ring.side == side_by_vectors(sense, drives=True, datum=datum, ring=True)
    assert planet.side == side_by_vectors(sense, drives=False, datum=-1)


def test_a_gear_whose_axis_points_the_other_way_is_the_same_gear():
    turned = {"u_axis_vector": (-1.0, 0.0, 0.0), "datum_face_orientation": "negative"}
    straight = {"datum_face_orientation": "positive"}
    for torque in (10.0, -10.0):
        same = loaded(stage_unit({WHEEL: straight}), WHEEL, torque)
        assert loaded(stage_unit({WHEEL: turned}), WHEEL, torque).side == same.side


MODIFICATION = 50


def modified(
    kind: str,
    values: Mapping[str, Any],
    flank: int = PINION_RIGHT,
    changes: Mapping[int, Mapping[str, Any]] | None = None,
) -> GearUnit:
    return stage_unit(
        {MODIFICATION: values, **(changes or {})},
        {MODIFICATION: kind},
        [relation(120, "reference", origin=flank, referenced=MODIFICATION)],
    )


def only_case(unit: GearUnit, torque: float = 10.0) -> Case:
    """Return the case of the stage, by default for the torque that loads right flanks."""
    (stage,) = StageCase.all_of(unit, {STAGE: (torque,)})
    return stage.case


def removed(gear: Toothing, roll: float | FloatArray, face: float | FloatArray = 0.0) -> FloatArray:
    """Return what is removed from a gear, um."""
    return gear.modification.material_removed(gear, roll, face) / 1e-6


def test_only_the_loaded_flank_is_modified():
    values = {"tip_relief_depth": 0.02, "tip_relief_datum_diameter": 42.0}
    assert only_case(modified("tip_relief", values), 10.0).pair.pinion.tip_relief_um == 20.0
    assert only_case(modified("tip_relief", values), -10.0).pair.pinion.tip_relief_um == 0.0
    assert only_case(modified("tip_relief", values, PINION_LEFT), -10.0).pair.pinion.tip_relief_um == 20.0


@pytest.mark.parametrize("shape", ["linear", "parabolic"])
def test_a_tip_relief_by_diameters_is_one_over_the_roll_length(shape):
    values = {"tip_relief_depth": 0.02, "tip_relief_datum_diameter": 42.0, "shape_of_relief": shape}
    unit = modified("tip_relief", {**values, "tip_relief_evaluation_reference": 43.5})
    case = only_case(unit)
    assert case.pair.pinion.flank_grid is None
    gear = gear_pair(case).pinion
    start, stated = gear.roll_length(21e-3), gear.roll_length(21.75e-3)
    power = 1 if shape == "linear" else 2
    for fraction in (0.0, 0.3, 1.0):
        roll = start + fraction * (stated - start)
        assert removed(gear, roll) == pytest.approx(20.0 * fraction**power, abs=1e-9)


def test_a_relief_by_its_length_runs_back_from_the_tip_along_the_line_of_action():
    gear = gear_pair(
        only_case(modified("tip_relief", {"tip_relief_depth": 0.02, "tip_relief_datum_length": 2.0}))
    ).pinion
    assert removed(gear, gear.tip_roll_length - 1e-3) == pytest.approx(10.0, abs=1e-9)
    assert removed(gear, gear.tip_roll_length - 2e-3) == pytest.approx(0.0, abs=1e-9)


def test_a_root_relief_ends_where_the_involute_begins():
    values = {"root_relief_depth": 0.01, "root_relief_datum_diameter": 38.8}
    gear = gear_pair(only_case(modified("root_relief", values))).pinion
    start = gear.roll_length(19.4e-3)
    assert removed(gear, gear.form_roll_length) == pytest.approx(10.0, abs=1e-9)
    assert removed(gear, 0.5 * (gear.form_roll_length + start)) == pytest.approx(5.0, abs=1e-9)
    assert removed(gear, start) == pytest.approx(0.0, abs=1e-9)


def test_a_profile_slope_over_part_of_the_profile_keeps_its_gradient():
    values = {"profile_slope": 0.006, "profile_evaluation_start": 39.0, "profile_evaluation_end": 43.0}
    gear = gear_pair(only_case(modified("profile_slope", values))).pinion
    low, high = gear.roll_length(19.5e-3), gear.roll_length(21.5e-3)
    assert removed(gear, high) - removed(gear, low) == pytest.approx(6.0, abs=1e-9)


def test_crownings_with_equal_ends_are_fields():
    values = {"profile_crowning_at_tip": 0.005, "profile_crowning_at_root": 0.005}
    assert only_case(modified("profile_crowning", values)).pair.pinion.profile_crowning_um == 5.0
    values = {"helix_crowning_amount_datum_face": 0.004, "helix_crowning_amount_non_datum_face": 0.004}
    assert only_case(modified("helix_crowning", values)).pair.pinion.helix_crowning_um == 4.0


UNEVEN = {"helix_crowning_amount_datum_face": 0.004, "helix_crowning_amount_non_datum_face": 0.010}
COORDINATES = np.linspace(0.0, 20.0, 1001)
"""From the datum face, mm. The pinion turns about +u: z = -u, towards the datum face."""


def uneven_crowning() -> FloatArray:
    """Return what the crowning with its highest point at 8 mm removes at the coordinates, um."""
    to_datum, to_other = ((COORDINATES - 8.0) / 8.0) ** 2, ((COORDINATES - 8.0) / 12.0) ** 2
    return np.where(COORDINATES < 8.0, 4.0 * to_datum, 10.0 * to_other)


@pytest.mark.parametrize("datum", SIGNS)
def test_a_crowning_with_different_ends_has_fields_of_each_face(datum):
    flank, orientation = (PINION_RIGHT, PINION_LEFT)[datum > 0], {"datum_face_orientation": DIRECTION[datum]}
    unit = modified("helix_crowning", {**UNEVEN, "helix_highest_point": 8.0}, flank, {PINION: orientation})
    gear = gear_pair(only_case(unit)).pinion
    assert gear.modification.flank_grid is None
    found = removed(gear, 7e-3, -datum * 1e-3 * (10.0 - COORDINATES))
    assert found == pytest.approx(uneven_crowning(), abs=1e-9)


def test_a_second_modification_of_a_kind_is_rasterized_with_its_difference():
    crowning = {**UNEVEN, "helix_highest_point": 8.0}
    unit = stage_unit(
        {51: crowning, 52: crowning},
        {51: "helix_crowning", 52: "helix_crowning"},
        [relation(120 + part, "reference", origin=PINION_RIGHT, referenced=part) for part in (51, 52)],
    )
    gear = gear_pair(only_case(unit)).pinion
    found = removed(gear, 7e-3, 1e-3 * (10.0 - COORDINATES))
    measured = np.abs(found - 2.0 * uneven_crowning()).max()
    fate, words = said(unit, PINION_RIGHT, "flank_grid")
    assert fate == "derived"
    assert measured / 1.2 <= max(float(words.rsplit(" ", 2)[1]), 1e-9) <= 0.05  # 1e-9 um: rounding


def test_a_profile_crowning_with_different_ends_has_fields_of_tip_and_root():
    values = {
        "profile_crowning_at_tip": 0.006,
        "profile_crowning_at_root": 0.002,
        "profile_highest_point": 41.0,
    }
    gear = gear_pair(only_case(modified("profile_crowning", values))).pinion
    highest = gear.roll_length(20.5e-3)
    assert gear.modification.flank_grid is None
    for end, amount in ((gear.tip_roll_length, 6.0), (gear.form_roll_length, 2.0)):
        assert removed(gear, 0.5 * (highest + end)) == pytest.approx(0.25 * amount, abs=1e-9)


@pytest.mark.parametrize(
    ("shape", "half"),
    [("exponential", math.expm1(0.5) / math.expm1(1.0)), ("logarithmic", math.log1p(0.5 * math.expm1(1.0)))],
)
def test_further_shapes_are_fields_where_the_depth_is_that_of_the_end(shape, half):
    values = {"tip_relief_depth": 0.02, "tip_relief_datum_diameter": 42.0, "shape_of_relief": shape}
    gear = gear_pair(only_case(modified("tip_relief", values))).pinion
    middle = 0.5 * (gear.roll_length(21e-3) + gear.tip_roll_length)
    assert gear.modification.flank_grid is None
    assert removed(gear, middle) == pytest.approx(20.0 * half, abs=1e-9)
    inner = gear_pair(
        only_case(modified("tip_relief", {**values, "tip_relief_evaluation_reference": 43.0}))
    ).pinion
    stated = 0.5 * (inner.roll_length(21e-3) + inner.roll_length(21.5e-3))
    assert removed(inner, stated) == pytest.approx(20.0 * half, abs=0.1)


@pytest.mark.parametrize(("torque", "datum"), list(itertools.product((10.0, -10.0), SIGNS)))
def test_an_end_relief_lies_at_its_face(torque, datum):
    orientation = {PINION: {"datum_face_orientation": DIRECTION[datum]}}
    values = {"end_relief_depth_datum_face": 0.012, "end_relief_length_datum_face": 4.0}
    flank = PINION_RIGHT if loaded(stage_unit(orientation), PINION, torque).side == "right" else PINION_LEFT
    unit = modified("end_relief_datum_face", values, flank, orientation)
    gear = gear_pair(only_case(unit, torque)).pinion
    at_datum = -math.copysign(1.0, torque) * datum  # z = -u for a driver that turns about +u
    assert removed(gear, 7e-3, at_datum * 10e-3) == pytest.approx(12.0, abs=1e-9)
    assert removed(gear, 7e-3, at_datum * 8e-3) == pytest.approx(6.0, abs=1e-9)
    assert removed(gear, 7e-3, -at_datum * 10e-3) == pytest.approx(0.0, abs=1e-9)


def test_end_reliefs_that_are_alike_are_one_field():
    both = {
        51: {"end_relief_depth_datum_face": 0.012, "end_relief_length_datum_face": 4.0},
        52: {"end_relief_depth_non_datum_face": 0.012, "end_relief_length_non_datum_face": 4.0},
    }
    unit = stage_unit(
        both,
        {51: "end_relief_datum_face", 52: "end_relief_non_datum_face"},
        [relation(120 + part, "reference", origin=PINION_RIGHT, referenced=part) for part in both],
    )
    pinion = only_case(unit).pair.pinion
    assert (pinion.end_relief_um, pinion.end_relief_length_mm, pinion.flank_grid) == (12.0, 4.0, None)


@pytest.mark.parametrize(
    ("kind", "values", "field"),
    [
        ("helix_slope", {"helix_slope": 0.008}, "helix_slope_um"),
        ("profile_twist", {"profile_twist": 0.008}, "flank_twist_um"),
    ],
)
def test_slope_and_twist_change_sign_with_the_datum_face(kind, values, field):
    amounts = []
    for datum, flank in ((-1, PINION_RIGHT), (1, PINION_LEFT)):
        changes = {PINION: {"datum_face_orientation": DIRECTION[datum]}}
        amounts.append(getattr(only_case(modified(kind, values, flank, changes)).pair.pinion, field))
    assert amounts[0] == -amounts[1] != 0.0


def test_a_twist_is_the_difference_of_the_profile_slopes_at_the_faces():
    gear = gear_pair(only_case(modified("profile_twist", {"profile_twist": 0.008}))).pinion
    tip, root = gear.tip_roll_length, gear.form_roll_length
    slopes = [removed(gear, tip, z) - removed(gear, root, z) for z in (-10e-3, 10e-3)]
    assert slopes[0] - slopes[1] == pytest.approx(8.0, abs=1e-9)  # the datum face is at +z


def test_a_topography_passes_through_its_amounts():
    diameters, faces = (38.5, 41.0, 43.8), (0.0, 10.0, 20.0)
    nodes = list(itertools.product(diameters, faces))
    amounts = tuple(1e-3 * (i % 4) for i in range(9))
    values = {
        "diameters_of_topographical_modification": tuple(node[0] for node in nodes),
        "coordinates_of_topographical_modification": tuple(node[1] for node in nodes),
        "topographical_modification_amounts": amounts,
    }
    unit = modified("topographical_modification", values)
    gear = gear_pair(only_case(unit)).pinion
    stated = float(said(unit, PINION_RIGHT, "flank_grid")[1].rsplit(" ", 2)[1])
    for (diameter, face), amount in zip(nodes, amounts, strict=True):
        found = removed(gear, gear.roll_length(0.5e-3 * diameter), 10e-3 - 1e-3 * face)
        assert found == pytest.approx(1e3 * amount, abs=stated + 1e-6)


def test_a_tangential_transition_is_smooth_and_keeps_the_amount():
    values = {
        "tip_relief_depth": 0.02,
        "tip_relief_datum_diameter": 41.6,
        "specify_tangential_transition": True,
        "tip_relief_diameter_where_tangential_transition_starts": 41.6,
        "tip_relief_diameter_where_tangential_transition_ends": 42.8,
    }
    gear = gear_pair(only_case(modified("tip_relief", values))).pinion
    first, last = gear.roll_length(20.8e-3), gear.roll_length(21.4e-3)
    assert removed(gear, gear.tip_roll_length) == pytest.approx(20.0, abs=0.05)
    # Half the slope's range is lost to the transition: C = m (l_a - (l_1 + l_2) / 2).
    slope = 20.0 / (gear.tip_roll_length - 0.5 * (first + last))
    assert removed(gear, last) == pytest.approx(0.5 * slope * (last - first), abs=0.05)


def test_what_has_no_extent_is_refused_and_leaves_the_case():
    unit = modified("triangular_tip_relief", {"triangular_tip_relief_depth": 0.01})
    assert only_case(unit).pair.pinion.flank_grid is None
    assert said(unit, MODIFICATION, "")[0] == "refused"


MIRRORED_FLANKS = {PINION_LEFT: PINION_RIGHT, PINION_RIGHT: PINION_LEFT, WHEEL_LEFT: WHEEL_RIGHT}
SKEW = {
    PINION_RIGHT: ("helix_slope", {"helix_slope": 0.008}),
    PINION_LEFT: ("helix_slope", {"helix_slope": 0.003}),
    WHEEL_RIGHT: ("profile_twist", {"profile_twist": 0.004}),
    WHEEL_LEFT: ("profile_twist", {"profile_twist": 0.012}),
}


def skew_unit(hand: int, datum: int, *, swapped: bool) -> GearUnit:
    """Return a helical stage with a modification of its own on each flank."""
    angle = math.radians(15.0)
    changes: dict[int, Mapping[str, Any]] = {
        PINION: {"helix_angle_reference_diameter": 15.0 * hand, "datum_face_orientation": DIRECTION[datum]},
        WHEEL: {"helix_angle_reference_diameter": -15.0 * hand, "datum_face_orientation": DIRECTION[datum]},
        STAGE: {"center_distance": 80.0 / math.cos(angle)},
    }
    flanks = {**MIRRORED_FLANKS, WHEEL_RIGHT: WHEEL_LEFT}
    types, relations = {}, []
    for number, (flank, (kind, values)) in enumerate(SKEW.items(), 60):
        changes[number], types[number] = values, kind
        origin = flanks[flank] if swapped else flank
        relations.append(relation(200 + number, "reference", origin=origin, referenced=number))
    return stage_unit(changes, types, relations)


@pytest.mark.parametrize("torque", [10.0, -10.0])
def test_a_mirrored_file_gives_the_mirrored_case(torque):
    # Mirrored in a plane across the axes: the hands change, the datum faces, and left is right from there.
    case = only_case(skew_unit(1, 1, swapped=False), torque)
    mirrored = only_case(skew_unit(-1, -1, swapped=True), torque)
    assert mirrored.pair.helix_angle_deg == -case.pair.helix_angle_deg
    assert mirrored.pair.pinion.helix_slope_um == -case.pair.pinion.helix_slope_um != 0.0
    assert mirrored.pair.wheel.flank_twist_um == -case.pair.wheel.flank_twist_um != 0.0
