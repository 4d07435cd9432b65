"""Bearings and housing of a REXS file: sides, seats, clearances, stiffnesses, and why some are bushings."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from opened_unit import deflection_of_unit, said, scene_of
from rexs_reference import needs_reference, reference
from rexs_stage import relation
from rexs_unit import (
    BALL,
    CASING,
    INPUT,
    LEFT,
    LINE,
    NORMAL_LOAD,
    RIGHT,
    ROLLER,
    ROW,
    at,
    inside,
    on_lines,
    place,
    two_stages,
)

from bounds.types import FloatArray
from dynamics.bearings.loaded_bearing import LoadedBearing
from lineofaction.gearbox.convert.scene_parts import rolling_bearing_of
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.rexs.files import read_rexs
from lineofaction.gearbox.rexs.model import Document
from lineofaction.gearbox.schemas.bearings import RollingBearingInput
from lineofaction.gearbox.schemas.scene import SceneInput

Parts = Mapping[int, tuple[str, dict[str, Any]]]


def by_name(unit: OpenedUnit) -> dict[int, RollingBearingInput]:
    assert unit.scene is not None, [line for line in unit.lines if line.fate == "refused"]
    return {int(bearing.name.split()[-1]): bearing for bearing in unit.scene.rolling_bearings}


def why(unit: OpenedUnit, number: int) -> str:
    assert unit.scene is not None and number not in by_name(unit)
    assert any(bushing.name.endswith(str(number)) for bushing in unit.scene.bushings)
    return said(unit, number, "")[1]


def thrusts(bearing: RollingBearingInput) -> tuple[float, float]:
    """Return the axial force of a bearing on a shaft that is pushed by 100 um along z, and against it."""
    made = rolling_bearing_of(bearing)
    loaded = LoadedBearing(made.row, locating=made.locating)
    moved = ((2e-5, 0.0, z, 0.0, 0.0) for z in (1e-4, -1e-4))
    force = [float(loaded.evaluate(d).force[2]) for d in moved]
    return force[0], force[1]


@pytest.mark.parametrize("arrangement", ["located", "cross-located"])
def test_the_thrust_of_drive_and_coast_goes_where_the_file_says(arrangement):
    """Of a cross-located pair the bearing to which the mesh pushes the shaft; always the locating one."""
    crossed = arrangement == "cross-located"
    sides = ("negative", "positive") if crossed else ("both_directions", "no_direction")
    own = [{"axial_force_absorption": side} for side in sides]
    unit = OpenedUnit.of(on_lines(*own, torques=(NORMAL_LOAD, -NORMAL_LOAD)))
    thrust = {}
    for case in deflection_of_unit(unit).deflection.cases:
        loads = {int(load.name.split()[-1]): load for load in case.bearings}
        axial = [loads[number].axial for number in (LEFT, RIGHT)]
        held = int(np.argmax(np.abs(axial)))
        assert abs(axial[1 - held]) < 1e-9 * abs(axial[held])
        thrust[np.sign(axial[held])] = axial[held]
        assert held == (int(axial[held] > 0.0) if crossed else 0)
    # tangential force on the pitch circle of 20 teeth, module 2, times the tangent of the helix angle
    axial_force = NORMAL_LOAD / (0.02 / np.cos(np.radians(15.0))) * np.tan(np.radians(15.0))
    assert sorted(thrust.values()) == pytest.approx([-axial_force, axial_force], rel=1e-6)


def test_a_catalog_line_is_stated_as_it_is():
    (bearing, *_) = by_name(OpenedUnit.of(on_lines({"axial_force_absorption": "both_directions"}))).values()
    stated = {"bore_mm": 25.0, "outside_diameter_mm": 62.0, "static_rating_n": 11600.0, "clearance_um": 10.0}
    assert bearing.catalog.model_dump() == stated
    assert (bearing.position_mm, bearing.dynamic_capacity_n) == (pytest.approx(15.0), 23400.0)
    assert (bearing.locating, bearing.axial_preload_n) == ("both", 0.0)


@pytest.mark.parametrize("u", [1.0, -1.0])
@pytest.mark.parametrize(
    ("stated", "held"),
    [
        ("both_directions", (True, True)),
        ("no_direction", (False, False)),
        ("positive", (True, False)),
        ("negative", (False, True)),
    ],
)
def test_a_deep_groove_bearing_holds_the_shaft_in_the_directions_of_its_own_u(stated, held, u):
    turned = {"axial_force_absorption": stated, "u_axis_vector": (u, 0.0, 0.0)}
    along, against = thrusts(by_name(OpenedUnit.of(on_lines(turned)))[LEFT])
    assert (along > 100.0, against < -100.0) == (held if u > 0.0 else held[::-1])
    assert all(force == 0.0 or abs(force) > 100.0 for force in (along, against))


def test_a_bearing_without_a_place_has_the_u_of_its_shaft():
    shaft = {"support_vector": (150.0, 0.0, 0.0), "u_axis_vector": (-1.0, 0.0, 0.0)}
    more = at(LEFT, "catalog", LINE | {"axial_force_absorption": "positive"})
    values = {k: v for k, v in more[LEFT][1].items() if k not in ROLES}
    bearing = by_name(OpenedUnit.of(two_stages({INPUT: shaft}, more={LEFT: (more[LEFT][0], values)})))[LEFT]
    assert bearing.position_mm == pytest.approx(135.0)
    along, against = thrusts(bearing)
    assert along == 0.0 and against < -100.0


@pytest.mark.parametrize("u", [1.0, -1.0])
@pytest.mark.parametrize("kind", ["radial_tapered_roller_bearing", "angular_contact_ball_bearing"])
@pytest.mark.parametrize("arrangement", ["X", "O"])
@pytest.mark.parametrize("of", ["", "_of_row"])
def test_rows_with_a_contact_angle_hold_the_side_that_the_file_states(arrangement, kind, u, of):
    """X: the bearing to the right holds a shaft that is pushed to the right; O: the other one.

    `u` turns the axes of both bearings against the shaft's.
    """
    sides = ("negative", "positive") if arrangement == "X" else ("positive", "negative")
    own = [{f"axial_force_absorption{of}": side, "bearing_type": kind} for side in sides]
    own = [values | {"u_axis_vector": (u, 0.0, 0.0)} for values in own]
    element = ROLLER if "roller" in kind else BALL
    found = by_name(OpenedUnit.of(inside(*own, element=element)))
    row = "roller" if "roller" in kind else "ball"
    angles = [getattr(found[number], row).contact_angle_deg for number in (LEFT, RIGHT)]
    assert np.sign(u) * np.array(angles) == pytest.approx(
        [-14.0, 14.0] if arrangement == "X" else [14.0, -14.0]
    )
    for number, angle in zip((LEFT, RIGHT), angles, strict=True):
        force = thrusts(found[number])
        assert force[0 if angle > 0.0 else 1] * angle > 100.0
        assert force[1 if angle > 0.0 else 0] == 0.0 or "ball" in kind


@pytest.mark.parametrize(
    ("left", "words"),
    [
        ({"axial_force_absorption": "both_directions"}, "does not say which direction its contact angle"),
        ({}, "does not say which direction its contact angle"),
        (
            {"axial_force_absorption": "positive", "axial_force_absorption_of_row": "negative"},
            "of the bearing and of its row are opposite",
        ),
    ],
)
def test_a_contact_angle_without_a_side_is_a_bushing(left, words):
    unit = OpenedUnit.of(inside(left, {"axial_force_absorption": "positive"}))
    assert words in why(unit, LEFT)
    assert list(by_name(unit)) == [RIGHT]


@pytest.mark.parametrize(
    ("values", "clearance", "fate"),
    [
        ({"operating_radial_bearing_clearance": 12.0, "radial_bearing_clearance": 20.0}, 12.0, "taken"),
        ({"mounted_radial_bearing_clearance": 15.0, "radial_bearing_clearance": 20.0}, 15.0, None),
        ({"radial_bearing_clearance": 20.0}, 20.0, None),
        (
            {"minimum_radial_bearing_clearance": 5.0, "maximum_radial_bearing_clearance": 20.0},
            12.5,
            "derived",
        ),
        ({}, 0.0, "defaulted"),
        ({"operating_radial_bearing_clearance": -4.0}, -4.0, "taken"),
        ({"operating_radial_bearing_clearance": 5e4}, 0.0, "defaulted"),
    ],
)
def test_the_clearance_nearest_to_operation_counts(values, clearance, fate):
    unit = OpenedUnit.of(on_lines({"operating_radial_bearing_clearance": None} | dict(values)))
    catalog = by_name(unit)[LEFT].catalog
    assert catalog is not None and catalog.clearance_um == pytest.approx(clearance, abs=1e-9)
    if fate is not None:
        assert said(unit, LEFT, "operating_radial_bearing_clearance")[0] == fate


@pytest.mark.parametrize(
    ("values", "clearance", "preload"),
    [
        ({}, 0.0, 0.0),
        ({"operating_axial_bearing_clearance": 30.0, "operating_radial_bearing_clearance": 1.0}, 30.0, 0.0),
        ({"operating_radial_bearing_clearance": 10.0}, 5.0 / np.tan(np.radians(14.0)), 0.0),
        ({"preload_distance": 8.0}, -8.0, 0.0),
        ({"preload_force": 500.0}, 0.0, 500.0),
        ({"preload_force": 500.0, "preload_distance": 8.0}, 0.0, 500.0),
    ],
)
def test_clearance_and_preload_of_a_contact_angle_are_along_the_axis(values, clearance, preload):
    own = [dict(values) | {"axial_force_absorption": side} for side in ("negative", "positive")]
    found = by_name(OpenedUnit.of(inside(*own)))
    for number, sign in ((LEFT, -1.0), (RIGHT, 1.0)):
        bearing = found[number]
        assert bearing.roller.clearance_um == pytest.approx(clearance, abs=1e-9)
        assert bearing.axial_preload_n == sign * preload


def test_cylindrical_rollers_hold_nothing_and_ribs_are_a_bushing():
    own = {"bearing_type": "radial_roller_bearing"}
    sides = [own | {"axial_force_absorption": side} for side in ("no_direction", "both_directions")]
    unit = OpenedUnit.of(inside(*sides, row=ROW | {"pressure_angle": 0.0}))
    (bearing,) = by_name(unit).values()
    assert thrusts(bearing) == (0.0, 0.0) and bearing.roller is not None
    assert "ribs carry axial force" in why(unit, RIGHT)
    fate, words = said(unit, RIGHT, "radial_stiffness")
    assert fate == "derived" and "tangent of the bearing's geometry" in words
    assert said(unit, RIGHT, "axial_stiffness")[0] == "defaulted"


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"radial_stiffness": 2e8}, "its stiffness is stated"),
        ({"operating_point_stiffness_f_v_d_v": 2e8}, "its stiffness is stated"),
        ({"radial_force_absorption": False}, "no radial force"),
        ({"radial_static_load_rating": None}, "missing"),
        ({"radial_static_load_rating": 1e6}, "no deep groove ball bearing has its catalog line"),
        ({"bearing_type": "radial_tapered_roller_bearing"}, "catalog line of a radial_tapered"),
        ({"bearing_type": None}, "without bearing_type"),
    ],
)
def test_a_bushing_says_why(values, words):
    unit = OpenedUnit.of(on_lines(values, {}))
    assert words in why(unit, LEFT)
    assert list(by_name(unit)) == [RIGHT]


def test_a_stiffness_without_end_is_ignored_beside_the_geometry():
    unit = OpenedUnit.of(on_lines({"radial_stiffness": 1e23, "axial_stiffness": 0.0}))
    assert LEFT in by_name(unit)
    assert said(unit, LEFT, "radial_stiffness") == ("ignored", "the stiffness follows from the geometry")


def test_a_rating_or_preload_that_no_bearing_has_is_left_out_and_said():
    unit = OpenedUnit.of(on_lines({"radial_dynamic_load_rating": 1e9}))
    assert by_name(unit)[LEFT].dynamic_capacity_n is None
    words = "1000000000.0 kN is not from 1 to 1e+09 N"
    assert said(unit, LEFT, "radial_dynamic_load_rating") == ("refused", words)
    own = [{"axial_force_absorption": side, "preload_force": 1e12} for side in ("negative", "positive")]
    assert by_name(OpenedUnit.of(inside(*own)))[LEFT].axial_preload_n == 0.0


def test_a_direction_that_the_file_lacks_is_defaulted_and_said():
    unit = OpenedUnit.of(on_lines({}))
    assert by_name(unit)[LEFT].locating == "both"
    assert said(unit, LEFT, "axial_force_absorption")[0] == "defaulted"


def test_a_shaft_in_the_outer_ring_is_on_a_bushing():
    number = 37
    more = {number: ("rolling_bearing_with_catalog_geometry", LINE | place(70.0, 0.0, 0.0))}
    side = relation(2000, "side", assembly=number, inner_part=CASING, outer_part=INPUT)
    assert "outer side" in why(OpenedUnit.of(two_stages(more=more, further=[side])), number)


def matrix_of(stiffness: FloatArray) -> dict[str, Any]:
    return {"reduced_static_stiffness_matrix": tuple(map(tuple, stiffness.tolist()))}


def housed(
    group: dict[str, Any], carried: dict[int, int | None], more: Parts = MappingProxyType({})
) -> Document:
    """Return the unit with an elastic casing, whose points carry bearings or nothing."""
    points = {point: ("reduction_point", {}) for point in carried}
    roles = [
        ("reference", {"origin": CASING, "referenced": 50}),
        *(("assembly", {"assembly": 50, "part": point}) for point in carried),
        *(("reference", {"origin": p, "referenced": bearing}) for p, bearing in carried.items() if bearing),
    ]
    further = [relation(2000 + n, kind, **row) for n, (kind, row) in enumerate(roles)]
    return two_stages(more={50: ("assembly_group", group), **points, **more}, further=further)


def on_input_shaft(stiffness: FloatArray) -> SceneInput:
    """Return the scene on a casing under both bearings of the input shaft, and a free point.

    u of the group is along v of the unit.
    """
    axes = place(0.0, 0.0, 0.0, u=(0.0, 1.0, 0.0))
    return scene_of(housed(axes | matrix_of(stiffness), {51: 32, 52: None, 53: 31}))


@pytest.mark.parametrize("held", [True, False])
def test_bearings_of_a_casing_are_bushings_where_nothing_holds_it_and_say_so(held):
    group = place(0.0, 0.0, 0.0) | matrix_of(np.diag([1e6] * 5 + [1e6 * held]))
    more = at(LEFT, "catalog", LINE) | at(RIGHT, "catalog", LINE)
    unit = OpenedUnit.of(housed(group, {51: LEFT}, more))
    if held:
        assert list(by_name(unit)) == [LEFT, RIGHT]
        assert unit.scene is not None and unit.scene.housings[0].bushings
    else:
        assert "the matrix of the casing is singular" in why(unit, LEFT)
        assert list(by_name(unit)) == [RIGHT]


ROLES = {"support_vector", "u_axis_vector", "w_axis_vector", "reference_component_for_position"}


@needs_reference
def test_cross_located_pairs_of_a_real_unit_hold_outwards():
    unit = OpenedUnit.of(read_rexs(reference("examples/SEW_3-stage_cylindrical_gearbox_1.0.rexs")))
    found = [(b.shaft, b.position_mm, b.locating) for b in unit.scene.rolling_bearings]
    shafts = {shaft for shaft, *_ in found}
    arranged = {shaft: [seat for _, _, seat in sorted(b for b in found if b[0] == shaft)] for shaft in shafts}
    assert sorted(arranged.values()) == sorted(
        [["both", "none"], ["negative", "positive"], ["negative", "positive"], ["none", "both"]]
    )
    (bushing,) = unit.scene.bushings
    assert "NUP204E" in bushing.name


def test_a_rigid_bearing_is_stiff_and_a_floating_one_free_along_the_axis():
    document = two_stages(
        {31: {"radial_stiffness": 1e23, "axial_stiffness": 1e23, "bending_stiffness": 1e15}}
    )
    first, second = scene_of(document).bushings[:2]
    assert (first.radial_stiffness_n_per_m, first.axial_stiffness_n_per_m) == (1e10, 1e10)
    assert first.stiffness_matrix is not None and first.stiffness_matrix[3][3] == 1e7
    assert (second.radial_stiffness_n_per_m, second.axial_stiffness_n_per_m) == (2e8, 0.0)
    assert said(OpenedUnit.of(document), 31, "radial_stiffness")[1].startswith("1e+23 N/m means rigid")


def test_a_stiffness_at_the_operating_point_turns_from_u_v_w_to_x_y_z():
    # axial 1, across v 2, across w 3 (1e8 N/m), about v 4 (1e7 N mm/rad), v with the rotation about w
    values = {"f_u_d_u": 1e8, "f_v_d_v": 2e8, "f_w_d_w": 3e8, "m_v_rot_v": 4e7, "m_w_rot_w": 5e7}
    values |= {"f_v_rot_w": 1e5, "m_w_d_v": 1e5}
    stated = {f"operating_point_stiffness_{name}": value for name, value in values.items()}
    matrix = scene_of(two_stages({31: stated})).bushings[0].stiffness_matrix
    assert matrix is not None
    expected = np.diag([2e8, 3e8, 1e8, 4e4, 5e4])
    expected[0, 4] = expected[4, 0] = 1e5
    assert np.array(matrix) == pytest.approx(expected, rel=1e-12, abs=1e-6)


def test_a_housing_matrix_turns_into_the_axes_of_the_scene():
    # per point u, v, w in N/mm, rotations in N mm/rad; the middle point carries nothing
    matrix = np.kron(np.eye(3), np.diag([1e5, 2e5, 3e5, 1e9, 2e9, 3e9]))
    matrix[0, 12] = matrix[12, 0] = -2e4
    scene = on_input_shaft(matrix)
    (housing,) = scene.housings
    assert housing.bushings == ("concept_bearing 32", "concept_bearing 31")
    stiffness = np.array(housing.stiffness_matrix)
    # u of the group is v of the unit, x of the scene; its v is -u, -z; its w is w, y
    assert np.diag(stiffness)[:6] == pytest.approx([1e8, 3e8, 2e8, 1e6, 3e6, 2e6])
    assert stiffness[0, 6] == pytest.approx(-2e7)


def test_points_of_a_housing_that_carry_nothing_follow_free_of_force():
    # springs k from the first point over the free one to the third: k / 2 between those
    matrix = np.zeros((18, 18))
    for a, b in ((0, 6), (6, 12)):
        matrix[np.ix_([a, b], [a, b])] += 1e5 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    (housing,) = on_input_shaft(matrix).housings
    x = np.array(housing.stiffness_matrix)[np.ix_([0, 6], [0, 6])]
    assert x == pytest.approx(0.5e8 * np.array([[1.0, -1.0], [-1.0, 1.0]]))


EXAMPLE = Path(__file__).parents[3] / "examples" / "two_stage" / "two_stage.rexs"


def test_the_example_opens_with_bearings_by_geometry_on_its_housing():
    document = read_rexs(EXAMPLE)
    unit, scene = OpenedUnit.of(document), scene_of(document)
    assert not [line for line in unit.lines if line.fate == "refused"]
    (housing,) = scene.housings
    assert housing.bushings == tuple(bearing.name for bearing in scene.rolling_bearings)
    assert len(scene.rolling_bearings) == 6 and scene.bushings == ()
    assert [case.torque_n_m for case in unit.load_cases] == [160.0, 120.0, 80.0, 40.0]
    assert [case.share for case in unit.load_cases] == [0.05, 0.15, 0.5, 0.3]
    (load,) = scene.loads
    assert load.torque_n_m == pytest.approx((80.0 * 63.0 / 25.0 * 74.0 / 21.0,), rel=1e-12)
    balls, rollers = scene.rolling_bearings[:2], scene.rolling_bearings[2:]
    assert [bearing.locating for bearing in balls] == ["both", "none"]
    assert all(bearing.roller is not None for bearing in rollers)
    angles = [row.contact_angle_deg for bearing in rollers if (row := bearing.roller)]
    assert np.sign(angles).tolist() == [-1, 1, -1, 1]
    matrix = np.array(housing.stiffness_matrix)
    assert np.linalg.eigvalsh(matrix)[0] > 0.0 and np.array_equal(matrix, matrix.T)
