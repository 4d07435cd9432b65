"""A REXS file as a scene: laws of place, sense, load and stiffness."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from opened_unit import content, said, scene_of
from rexs_stage import relation
from rexs_unit import (
    BEVEL,
    BEVEL_RELATIONS,
    CARRIER,
    CENTER_DISTANCES,
    GEARS,
    INPUT,
    MACHINE,
    MIDDLE,
    MOTOR,
    NORMAL_LOAD,
    NORMAL_SPEED,
    OUTPUT,
    PLANETS,
    ROOT,
    STAGES,
    antiparallel,
    mirrored,
    planetary,
    two_stages,
)

from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.rexs.model import Document

RATIO = 3.0 * 2.0


def test_axes_are_as_far_apart_as_the_center_distances():
    scene = scene_of(two_stages())
    origins = [np.array(shaft.origin_mm[:2]) for shaft in scene.shafts]
    distances = [float(np.linalg.norm(b - a)) for a, b in pairwise(origins)]
    assert distances == pytest.approx(CENTER_DISTANCES, rel=1e-12)
    assert [gear.position_mm for gear in scene.gears] == pytest.approx([60.0, 60.0, 110.0, 110.0])


def rotation(axis: int, degrees: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    angle, others = math.radians(degrees), [index for index in range(3) if index != axis]
    matrix = np.eye(3)
    matrix[np.ix_(others, others)] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    return matrix


def turned_document(turn: np.ndarray[Any, np.dtype[np.float64]], *, root: bool) -> Document:
    vectors = ("support_vector", "u_axis_vector", "w_axis_vector")

    def each(number, _kind, values):
        if (number == ROOT) != root:
            return values
        return {k: tuple(turn @ v) if k in vectors else v for k, v in values.items()}

    return two_stages(each=each)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_unit_turned_in_space_is_the_same_scene(axis):
    turned = turned_document(rotation(axis, 40.0), root=True)
    assert content(scene_of(turned)) == content(scene_of(two_stages()))


def test_shafts_turned_about_u_turn_the_scene_about_z():
    plain, turned = (content(scene_of(turned_document(rotation(0, a), root=False))) for a in (0.0, 40.0))
    spin = rotation(2, 40.0)[:2, :2]
    for before, after in zip(plain["shafts"], turned["shafts"], strict=True):
        assert after["origin_mm"][:2] == pytest.approx(list(spin @ before["origin_mm"][:2]), abs=1e-6)
        assert after["origin_mm"][2] == before["origin_mm"][2]
    assert turned["drives"] == plain["drives"]


@pytest.mark.parametrize("shaft", [INPUT, MIDDLE])
def test_a_shaft_described_from_its_other_end_is_the_same_shaft(shaft):
    assert content(scene_of(antiparallel(shaft, 150.0))) == content(scene_of(two_stages()))


def test_a_mirrored_unit_is_the_mirrored_scene():
    plain, image = content(scene_of(two_stages())), content(scene_of(mirrored()))
    for before, after in zip(plain["shafts"], image["shafts"], strict=True):
        x, y, z = before["origin_mm"]
        assert after["origin_mm"] == [-x + 0.0, y, z]
    assert image["drives"][0]["speed_rpm"] == [-plain["drives"][0]["speed_rpm"][0]]
    assert image["loads"] == plain["loads"]
    cases = [OpenedUnit.of(document).cases for document in (two_stages(), mirrored())]
    assert [(case.driver, case.driven) for case in cases[0]] == [
        (case.driver, case.driven) for case in cases[1]
    ]


def test_shafts_without_places_follow_from_the_angles_of_the_stages():
    places = ("support_vector", "u_axis_vector", "w_axis_vector", "reference_component_for_position")

    def each(_number, _kind, values):
        return {name: value for name, value in values.items() if name not in places}

    bare = two_stages(each=each)
    assert content(scene_of(bare)) == content(scene_of(two_stages()))
    assert said(OpenedUnit.of(bare), OUTPUT, "support_vector")[0] == "derived"


def test_a_load_that_states_nothing_balances_the_torques():
    silent = {MACHINE: {"transmits_torque": None}}
    assert content(scene_of(two_stages(silent))) == content(scene_of(two_stages()))
    assert said(OpenedUnit.of(two_stages(silent)), MACHINE, "torque_around_u_axis")[0] == "derived"
    turned_about = {MOTOR: {"torque_around_u_axis": None}} | {
        MACHINE: {"transmits_torque": None, "torque_around_u_axis": -RATIO * NORMAL_LOAD}
    }
    assert content(scene_of(two_stages(turned_about))) == content(scene_of(two_stages()))


def test_a_train_without_a_load_at_its_other_end_is_loaded_at_the_shaft():
    weight = {MACHINE: ("additional_mass", {"u_coordinate_on_shaft": 150.0, "mass_of_component": 1.0})}
    cases = [{MOTOR: ("external_load", {"torque_around_u_axis": t * NORMAL_LOAD})} for t in (1.0, 0.5)]
    document = two_stages(more=weight, cases=cases)
    (load,) = scene_of(document).loads
    assert (load.shaft, load.position_mm) == ("shaft 5", 0.0)
    assert load.torque_n_m == (pytest.approx(RATIO * NORMAL_LOAD, rel=1e-11),)
    fate, words = said(OpenedUnit.of(document), OUTPUT, "external_load")
    assert fate == "refused" and "none at this end" in words
    torques = [case.torque_n_m for case in OpenedUnit.of(document).load_cases]
    assert torques == pytest.approx([NORMAL_LOAD, 0.5 * NORMAL_LOAD])


@pytest.mark.parametrize("mass", [1.0, 0.0, -1.0, None])
def test_a_disc_has_a_mass_above_zero_or_is_left_out(mass):
    stated = {"u_coordinate_on_shaft": 150.0} | ({} if mass is None else {"mass_of_component": mass})
    unit = OpenedUnit.of(two_stages(more={MACHINE: ("additional_mass", stated)}))
    whole = mass is not None and mass > 0.0
    assert [disc.inertia.mass_kg for disc in unit.scene.discs] == ([mass] if whole else [])
    assert (said(unit, MACHINE, "") == ("refused", "no mass is stated")) != whole


def test_teeth_below_zero_make_no_ring_of_an_external_gear():
    unit = OpenedUnit.of(two_stages({GEARS[0]: {"number_of_teeth": -20}}))
    fate, words = said(unit, STAGES[0], "")
    assert fate == "refused" and "number_of_teeth = -20" in words and "above 0" in words
    (drive,) = unit.scene.drives  # of the second stage, which turns against the motor
    assert drive.speed_rpm == (pytest.approx(-NORMAL_SPEED / 3.0),)


def test_the_motor_drives_and_statics_gives_the_load():
    scene = scene_of(two_stages())
    (drive,), (load,) = scene.drives, scene.loads
    assert (drive.shaft, drive.speed_rpm) == ("shaft 3", (NORMAL_SPEED,))
    assert (load.shaft, load.torque_n_m) == ("shaft 5", (pytest.approx(RATIO * NORMAL_LOAD, rel=1e-11),))
    assert said(OpenedUnit.of(two_stages()), MACHINE, "torque_around_u_axis") == (
        "derived",
        "-600 N m in nominal: statics of the train",
    )


def test_power_from_the_other_end_drives_the_other_gears():
    changes = {MOTOR: {"torque_around_u_axis": -NORMAL_LOAD}}
    unit, scene = OpenedUnit.of(two_stages(changes)), scene_of(two_stages(changes))
    assert [case.driver for case in unit.cases] == [12, 14]
    assert scene.drives[0].shaft == "shaft 5"
    assert scene.drives[0].speed_rpm == (pytest.approx(NORMAL_SPEED / RATIO, rel=1e-11),)
    assert scene.loads[0].torque_n_m == (pytest.approx(NORMAL_LOAD, rel=1e-11),)


def test_a_power_is_a_torque_at_the_speed():
    power = NORMAL_LOAD * NORMAL_SPEED * math.pi / 30.0 / 1e3
    stated = two_stages({MOTOR: {"torque_around_u_axis": None, "power": power}})
    assert content(scene_of(stated))["loads"] == content(scene_of(two_stages()))["loads"]


def test_the_scene_runs_at_the_load_case_of_the_largest_share():
    def case(share, torque, speed):
        return {
            ROOT: ("gear_unit", {"operating_time_fraction": share}),
            INPUT: ("shaft", {"rotational_speed": speed}),
            MOTOR: ("external_load", {"torque_around_u_axis": torque}),
        }

    document = two_stages(cases=(case(20.0, 50.0, 900.0), case(70.0, 80.0, 1200.0), case(10.0, -30.0, 600.0)))
    unit = OpenedUnit.of(document)
    rows = [(c.share, c.torque_n_m, c.speed_rpm, c.direction) for c in unit.load_cases]
    assert rows == [(0.2, 50.0, 900.0, "drive"), (0.7, 80.0, 1200.0, "drive"), (0.1, 30.0, 600.0, "coast")]
    assert scene_of(document).drives[0].speed_rpm == (1200.0,)
    assert unit.cases[0].case.load.torque_n_m == (50.0, 80.0)


def test_sections_without_a_place_are_summed_in_order():
    unit = OpenedUnit.of(
        two_stages({130: {"u_coordinate_on_shaft": None}, 131: {"u_coordinate_on_shaft": None}})
    )
    assert unit.scene.shafts[0].length_mm == pytest.approx(150.0, rel=1e-12)
    assert said(unit, 131, "u_coordinate_on_shaft") == ("derived", "50 mm, the sum of the lengths before it")


def test_the_bore_is_the_diameter_of_the_shaft_under_the_middle_of_the_gear():
    """One writer gives the begin of a gear as its coordinate: there the shaft is thinner."""
    unit = OpenedUnit.of(two_stages({11: {"u_coordinate_on_shaft": 45.0}}))
    assert unit.cases[0].case.pair.pinion.bore_diameter_mm == 30.0
    assert said(unit, 11, "inner_diameter") == (
        "derived",
        "bore_diameter_mm 30: the shaft's outer diameter there",
    )


def test_a_planetary_set_turns_and_carries_by_willis():
    scene = scene_of(planetary())
    ratio = 1.0 + 64.0 / 20.0
    by_shaft = {drive.shaft: drive.speed_rpm for drive in scene.drives}
    assert by_shaft == {"shaft 3": (1000.0,), "shaft 4": (0.0,)}
    (load,) = scene.loads
    assert (load.shaft, load.torque_n_m) == (f"shaft {CARRIER}", (pytest.approx(90.0 * ratio, rel=1e-10),))
    (planets,) = scene.planets
    assert (planets.planet, planets.number, planets.angles_deg) == (f"shaft {PLANETS[0]}", 3, None)
    assert {shaft.frame for shaft in scene.shafts} == {f"shaft {CARRIER}"}
    cases = OpenedUnit.of(planetary()).cases
    assert [len(case.equal) for case in cases] == [2, 2]
    assert cases[0].case.load.torque_n_m == (pytest.approx(30.0, rel=1e-8),)


def test_no_angle_between_the_gears_of_a_stepped_planet_is_made_up():
    """The phases of a planet of one gear follow from its teeth; of two gears no file says how they stand."""
    assert all(line.item != "tooth_angle" for line in OpenedUnit.of(planetary()).lines)
    how, words = said(OpenedUnit.of(planetary(step=18)), 16, "tooth_angle")
    assert how == "defaulted" and "tooth_angles_deg" in words
    offset = [mesh.position_offset for mesh in scene_of(planetary(step=18)).meshes]
    assert offset == [None, None]


def test_planets_may_begin_at_any_angle():
    for turned in (0.0, 25.0):
        (planet,) = [s for s in scene_of(planetary(turned)).shafts if s.name == f"shaft {PLANETS[0]}"]
        angle = math.radians(turned)
        expected = [42.0 * math.sin(angle), 42.0 * math.cos(angle)]
        assert planet.origin_mm[:2] == pytest.approx(expected, abs=1e-9)


def test_a_bevel_stage_is_cut_off_and_its_torque_is_a_load():
    load = {"u_coordinate_on_shaft": 0.0, "torque_around_u_axis": NORMAL_LOAD / 3.0}
    more = BEVEL | {43: ("external_load", load)}
    changes = {MOTOR: {"torque_around_u_axis": None}, INPUT: {"rotational_speed": None}}
    changes[6] = {"rotational_speed": 3.0 * NORMAL_SPEED}
    further = [*BEVEL_RELATIONS, relation(2000, "assembly", assembly=6, part=43)]
    scene = scene_of(two_stages(changes, more=more, further=further))
    assert [shaft.name for shaft in scene.shafts] == ["shaft 3", "shaft 4", "shaft 5"]
    assert abs(scene.drives[0].speed_rpm[0]) == pytest.approx(NORMAL_SPEED, rel=1e-11)
    assert scene.loads[0].torque_n_m == (pytest.approx(RATIO * NORMAL_LOAD, rel=1e-11),)


def test_a_bearing_between_two_shafts_leaves_their_speeds_alone():
    changes = {OUTPUT: {"support_vector": (155.0, 0.0, 0.0)}}
    sides = relation(2000, "side", assembly=60, inner_part=INPUT, outer_part=OUTPUT)
    more = {60: ("concept_bearing", {"radial_stiffness": 1e8, "u_coordinate_on_shaft_inner_side": 150.0})}
    unit = OpenedUnit.of(two_stages(changes, more=more, further=[sides]))
    (coupling,) = unit.scene.couplings
    assert coupling.torsional_stiffness_n_m_per_rad == 0.0
    assert np.diag(coupling.stiffness_matrix) == pytest.approx([1e8, 1e8, 0.0, 0.0, 0.0, 0.0])
