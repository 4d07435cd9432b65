"""External loads of a REXS file as forces of a scene and its load cases: axes, signs, places, reactions."""

import tomllib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from command_line import loa
from opened_unit import deflection_of_unit, scene_of
from rexs_stage import relation
from rexs_unit import (
    BELT,
    BEVEL,
    BEVEL_RELATIONS,
    CARRIER,
    INPUT,
    MOTOR,
    PLANETS,
    RING,
    ROOT,
    SUN,
    antiparallel,
    component,
    mirrored,
    planetary,
    pulled,
    two_stages,
)

from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.from_rexs.unit_answer import unit_json
from lineofaction.gearbox.from_rexs.unit_files import LOAD_CASES_FILE
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import serialized
from lineofaction.gearbox.rexs.model import Document
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.studies.deflect import Inputs
from lineofaction.gearbox.studies.deflect.cases import load_cases
from service.schemas.answers import UnitBody

LEFT, RIGHT, END = 15.0, 140.0, 150.0
"""u of the bearings and of the end of the input shaft, mm."""
VALUES = {
    "force_u_direction": 40.0,
    "force_v_direction": 1000.0,
    "force_w_direction": -300.0,
    "torque_around_v_axis": 6.0,
    "torque_around_w_axis": -9.0,
}
FORCES = list(VALUES)
Vectors = tuple[Any, Any]


def forces_of(document: Document) -> dict[str, Vectors]:
    """Return force and moment of each force of the scene, which dynamics takes."""
    return {force.name: (force.force_n, force.moment_n_m) for force in scene_of(document).forces}


def lines_of(unit: OpenedUnit, number: int) -> dict[str, list[tuple[str, str]]]:
    """Return fates and words by attribute of a component, in the order of the file."""
    lines = [line for line in unit.lines if line.component == number and line.item]
    return {
        item: [(line.fate, line.words) for line in lines if line.item == item]
        for item in dict.fromkeys(line.item for line in lines)
    }


def test_an_overhung_force_is_carried_as_computed_by_hand():
    """1000 N at 10 mm beyond the right bearing of 125 mm: 1080 N on it, -80 N on the left one."""
    cases = [{"force_v_direction": 1000.0}, {"force_w_direction": -500.0, "torque_around_v_axis": 25.0}, {}]
    loads = pulled(u_coordinate_on_shaft=END, cases=cases)
    torques = (80.0, -40.0, 60.0)
    for case, torque in zip(loads["cases"], torques, strict=True):
        case[MOTOR] = ("external_load", {"torque_around_u_axis": torque})
    unit = OpenedUnit.of(two_stages(**loads))
    assert [case.direction for case in unit.load_cases] == ["drive", "coast", "drive"]
    plain = [{BELT: ("external_load", {}), MOTOR: case[MOTOR]} for case in loads["cases"]]
    without = OpenedUnit.of(two_stages(**{**loads, "cases": plain}))
    assert without.scene is not None and without.scene.forces == ()
    pushed = reactions(unit) - reactions(without)
    hand = [
        [[-80.0, 0.0, 0.0], [1080.0, 0.0, 0.0]],
        [[0.0, 40.0 + 200.0, 0.0], [0.0, -540.0 - 200.0, 0.0]],
        np.zeros((2, 3)),
    ]
    assert pushed == pytest.approx(np.array(hand), rel=1e-9, abs=1e-6)


def reactions(unit: OpenedUnit) -> Any:
    """Return the forces on the bearings of the input shaft, (cases, 2, 3)."""
    cases = deflection_of_unit(unit).deflection.cases
    names = ("concept_bearing 31", "concept_bearing 32")
    by_case = [{load.name: load.force[:3] for load in case.bearings} for case in cases]
    return np.array([[own[name] for name in names] for own in by_case])


def test_beyond_the_end_of_its_shaft_a_force_acts_with_its_lever():
    unit, at = OpenedUnit.of(two_stages(**pulled(u_coordinate_on_shaft=END + 20.0, **VALUES))), BELT
    (force,) = unit.scene.forces
    assert (force.shaft, force.position_mm) == ("shaft 3", pytest.approx(END, rel=1e-12))
    # x, y, z are v, w, u; the lever of 20 mm adds -0.02 F_w about v and 0.02 F_v about w
    assert force.force_n == (1000.0, -300.0, 40.0)
    assert force.moment_n_m == pytest.approx((6.0 + 6.0, -9.0 + 20.0, 0.0), rel=1e-12)
    assert lines_of(unit, at)["u_coordinate_on_shaft"] == [
        ("derived", "20 mm beyond the end of its shaft: the force is there, with its moment")
    ]


def test_forces_are_along_the_axes_of_their_shaft():
    """With w of the shaft along v of the unit, its v is against w of the unit."""
    changes = {INPUT: {"w_axis_vector": (0.0, 1.0, 0.0)}}
    ((force, moment),) = forces_of(
        two_stages(changes, **pulled(u_coordinate_on_shaft=END, **VALUES))
    ).values()
    assert force == pytest.approx((-300.0, -1000.0, 40.0), rel=1e-12)
    assert moment == pytest.approx((-9.0, -6.0, 0.0), rel=1e-12)


def test_a_shaft_described_from_its_other_end_is_pulled_the_same_way():
    loads = pulled(u_coordinate_on_shaft=100.0, **VALUES)
    plain, other = (
        OpenedUnit.of(document) for document in (two_stages(**loads), antiparallel(INPUT, END, **loads))
    )
    for own, seen in zip(plain.scene.forces, other.scene.forces, strict=True):
        assert seen.position_mm == pytest.approx(own.position_mm, rel=1e-12)
        assert (seen.force_n, seen.moment_n_m) == (own.force_n, own.moment_n_m)


def test_the_mirrored_unit_is_pulled_to_the_other_side():
    """In x, which is v: forces are mirrored, moments are against what is mirrored."""
    loads = pulled(u_coordinate_on_shaft=END, **VALUES)
    (plain,), (image,) = (forces_of(make(**loads)).values() for make in (two_stages, mirrored))
    assert image[0] == tuple(np.array(plain[0]) * [-1.0, 1.0, 1.0])
    assert image[1] == tuple(np.array(plain[1]) * [1.0, -1.0, 1.0])
    assert np.count_nonzero([*plain[0], *plain[1]]) == 5


def test_the_torque_of_a_load_drives_and_is_no_moment_of_its_force():
    changes = {MOTOR: {"force_v_direction": 70.0, "torque_around_w_axis": 3.0}}
    plain, unit = (OpenedUnit.of(two_stages(changed)) for changed in ({}, changes))
    assert (unit.scene.loads, unit.scene.drives) == (plain.scene.loads, plain.scene.drives)
    assert forces_of(two_stages(changes)) == {"external_load 41": ((70.0, 0.0, 0.0), (0.0, 3.0, 0.0))}
    assert lines_of(unit, MOTOR)["torque_around_u_axis"] == [("taken", "torque about u from outside, N m")]


def test_a_load_case_sets_what_it_states_and_keeps_the_rest():
    """The second case has the largest share: the scene is under it, and it states nothing."""
    cases = [{"force_v_direction": 200.0}, {}, {"force_v_direction": 0.0}, {"force_v_direction": 100.0}]
    loads = pulled(u_coordinate_on_shaft=END, force_v_direction=100.0, force_w_direction=5.0, cases=cases)
    for case, share in zip(loads["cases"], (20.0, 40.0, 20.0, 20.0), strict=True):
        case[ROOT] = ("gear_unit", {"operating_time_fraction": share})
    unit = OpenedUnit.of(two_stages(**loads))
    assert forces_of(two_stages(**loads)) == {"external_load 44": ((100.0, 5.0, 0.0), (0.0, 0.0, 0.0))}
    tables = tomllib.loads(unit.files()[LOAD_CASES_FILE])
    read = [case.forces for case in load_cases(validated(Inputs, tables).load_cases)]
    assert [[(part.name, part.force, part.moment) for part in case] for case in read] == [
        [("external_load 44", (200.0, 5.0, 0.0), (0.0, 0.0, 0.0))],
        [],
        [("external_load 44", (0.0, 5.0, 0.0), (0.0, 0.0, 0.0))],
        [],
    ]


def test_the_answer_and_the_verb_show_the_forces_that_differ(tmp_path):
    cases = [{"force_v_direction": 200.0}, {}]
    document = two_stages(**pulled(u_coordinate_on_shaft=END, force_w_direction=5.0, cases=cases))
    answer = UnitBody.model_validate(unit_json(OpenedUnit.of(document)))
    assert [[force.force_n for force in case.forces] for case in answer.load_cases] == [[], [[0.0, 5.0, 0.0]]]
    (tmp_path / "unit.rexs").write_bytes(serialized(document, "unit.rexs"))
    shown = loa("open", tmp_path / "unit.rexs", "-o", tmp_path / "unit")
    assert "external_load 44 [0.0, 5.0, 0.0] N and [0.0, 0.0, 0.0] N m in x, y, z" in shown.stdout


def test_a_force_of_other_cases_alone_is_zero_in_the_scene():
    loads = pulled(u_coordinate_on_shaft=END, cases=[{}, {"force_v_direction": 200.0}])
    assert forces_of(two_stages(**loads)) == {"external_load 44": ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))}


def test_every_component_of_a_force_is_accounted_for_in_every_case():
    loads = pulled(
        u_coordinate_on_shaft=END,
        width_of_external_load=30.0,
        cases=[VALUES, {**VALUES, "force_w_direction": 0.0}],
    )
    lines = lines_of(OpenedUnit.of(two_stages(**loads)), BELT)
    assert [fate for fate, _ in lines["force_v_direction"]] == ["taken", "taken"]
    assert lines["force_w_direction"] == [("taken", "force along w of the shaft, N"), ("ignored", "0")]
    assert lines["torque_around_w_axis"][0] == ("taken", "moment about w of the shaft, N m")
    assert lines["width_of_external_load"][0][0] == "ignored"


def test_a_force_that_no_scene_can_have_is_refused_with_its_reason():
    nowhere = {**pulled(**VALUES, cases=[VALUES]), "further": []}
    apart = pulled(6, **VALUES)
    apart["more"] |= BEVEL
    apart["further"] += BEVEL_RELATIONS
    for loads, reason in ((nowhere, "acts on no shaft"), (apart, "acts on a shaft that the scene has not")):
        assert forces_of(two_stages(**loads)) == {}
        lines = lines_of(OpenedUnit.of(two_stages(**loads)), BELT)
        assert all(set(lines[item]) == {("refused", reason)} for item in FORCES)
        assert len(lines["force_v_direction"]) == 1 + len(loads["cases"])


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 2e9])
def test_a_force_that_is_no_size_is_refused_by_its_component(value):
    loads = pulled(u_coordinate_on_shaft=END, cases=[{"force_v_direction": value}])
    with pytest.raises(BadInput, match=r"load case 1.*44.*force_v_direction"):
        OpenedUnit.of(two_stages(**loads))


@pytest.mark.parametrize(
    ("shaft", "taken"), [(SUN, True), (RING, True), (CARRIER, True), (PLANETS[0], False)]
)
def test_forces_on_a_planetary_set_act_on_its_axis_alone(shaft, taken):
    model, load = planetary().model, {"u_coordinate_on_shaft": 10.0, **VALUES}
    components = (*model.components, component(BELT, "external_load", load))
    relations = (*model.relations, relation(2900, "assembly", assembly=shaft, part=BELT))
    document = Document(replace(model, components=components, relations=relations))
    found = forces_of(document)
    assert bool(found) == taken
    if taken:
        assert found["external_load 44"] == ((1000.0, -300.0, 40.0), (6.0, -9.0, 0.0))
    else:
        reason = "acts on a planet, and a scene has one for all of its set"
        assert lines_of(OpenedUnit.of(document), BELT)["force_v_direction"] == [("refused", reason)]
