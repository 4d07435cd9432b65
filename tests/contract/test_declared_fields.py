"""A declared figure is at every entry point: case, question, design variable, scatter, names in messages."""

import json
from dataclasses import fields, replace
from typing import Any

import pytest
from pydantic import ValidationError

from bounds import Direction, Kind, written
from fe_contact.analysis.analyze import analyze
from fe_contact.errors import InputError
from fe_contact.flank.modification import FlankModification
from fe_contact.geometry import BoreSeat, Gear, GearBlank, GearPair, Key, RingGear, Shaft
from fe_contact.material import Material
from fe_contact.microgeometry.variables import ACROSS_FACE, QUANTITIES
from fe_contact.plausibility import pair_findings
from lineofaction.gearbox.convert.boundary_names import boundary_name, case_field
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.declared import Figure, figures
from lineofaction.gearbox.schemas.gear import SHARED
from lineofaction.gearbox.schemas.live import LiveInput
from lineofaction.gearbox.studies.optimize import GearScatterInput, GearVariablesInput
from service.schemas.examples import CASE

FIGURES = figures(FlankModification)
EVERY = pytest.mark.parametrize("figure", FIGURES, ids=[figure.name for figure in FIGURES])
DEPTHS = pytest.mark.parametrize(
    "figure",
    [figure for figure in FIGURES if figure.what.kind in (Kind.AMOUNT, Kind.DEVIATION)],
    ids=lambda figure: figure.name,
)


def with_length(figure: Figure) -> dict[str, Any]:
    """Return the example of a figure in SI, with that of its length, or of the amount whose length it is."""
    names = {figure.name, f"{figure.name}_length", figure.name.removesuffix("_length")}
    return {each.name: each.what.example for each in FIGURES if each.name in names}


def as_written(facts: dict[str, Any]) -> dict[str, Any]:
    return {each.field: each.boundary_value(facts[each.name]) for each in FIGURES if each.name in facts}


def test_all_but_the_grid_are_declared_numbers_or_names():
    assert {entry.name for entry in fields(FlankModification)} - {figure.name for figure in FIGURES} == {
        "flank_grid"
    }


@EVERY
def test_a_case_and_the_library_mean_the_same(figure):
    facts = with_length(figure)
    table = json.loads(json.dumps(CASE))
    table["pair"] |= {"helix_angle_deg": 10.0, "center_distance_mm": 81.5}
    table["pair"]["pinion"] |= as_written(facts)
    case = Case.model_validate_json(json.dumps(table))
    read, meant = gear_pair(case).pinion.modification, FlankModification(**facts)
    for each in FIGURES:
        value = getattr(meant, each.name)
        near = pytest.approx(value, rel=1e-15) if isinstance(value, float) else value
        assert getattr(read, each.name) == near, each.name
    assert figure.boundary_value(figure.default) == getattr(case.pair.wheel, figure.field)


LATER = [figure for figure in FIGURES if figure.what.omit_default]


def test_a_case_is_written_without_later_figures_that_it_does_not_use():
    """So it keeps the address of its result."""
    table = json.loads(json.dumps(CASE))
    plain = Case.model_validate_json(json.dumps(table)).model_dump(mode="json")["pair"]["pinion"]
    gear = GEARS[Gear]
    assert len(LATER) == 23
    assert not {figure.field for figure in LATER} & set(plain)
    assert not {figure.name for figure in LATER} & set(written(gear)["modification"])
    assert written(gear)["modification"]["tip_relief"] == plain["tip_relief_um"] == 0.0


@pytest.mark.parametrize("figure", [each for each in LATER if each.what.kind is not Kind.SHAPE])
def test_a_case_is_written_with_the_later_figures_that_it_uses(figure):
    facts = with_length(figure)
    table = json.loads(json.dumps(CASE))
    table["pair"]["pinion"] |= as_written(facts)
    found = Case.model_validate_json(json.dumps(table)).model_dump(mode="json")["pair"]["pinion"]
    assert found[figure.field] == figure.boundary_value(facts[figure.name])
    assert written(FlankModification(**facts))[figure.name] == facts[figure.name]


@EVERY
def test_the_schema_has_the_bound_of_the_library(figure):
    schema = Case.model_json_schema()["$defs"]["GearInput"]["properties"][figure.field]
    if figure.what.kind is Kind.SHAPE:
        assert tuple(schema["enum"]) == figure.what.bound.names
        return
    for end in (schema["minimum"], schema["maximum"]):
        value = end * figure.unit.factor
        assert figure.what.limits.holds(value)
        beyond = value + (1e-9 if end == schema["maximum"] else -1e-9)
        with pytest.raises(InputError) as caught:
            FlankModification(**{figure.name: beyond})
        assert caught.value.field == figure.name


@EVERY
def test_it_can_be_changed_live_and_is_told_by_its_own_name(figure):
    change = as_written(with_length(figure))
    question = LiveInput.model_validate_json(json.dumps({"torque_n_m": [1.0], "pinion": change}))
    assert question.pinion.model_dump(exclude_none=True) == change
    assert boundary_name(f"pinion.{figure.name}") == f"pinion.{figure.field}"


BODIES = {
    Material: ("pair.pinion.material", {}),
    Shaft: ("pair.pinion.shaft", {"length": 0.2, "diameter": 0.04, "position": 0.06}),
    GearBlank: ("pair.pinion.blank", {"rim_thickness": 0.006, "web_thickness": 0.012}),
    BoreSeat: ("pair.pinion.seat", {"radial_foundation": 1e13, "tangential_foundation": 1e13}),
    Key: ("pair.pinion.seat.key", {"width": 0.006}),
}
"""Where a case has each body, and what it needs."""


@pytest.mark.parametrize("kind", BODIES, ids=lambda kind: kind.__name__)
def test_a_body_of_a_case_means_that_of_the_library(kind):
    place, facts = BODIES[kind]
    table = json.loads(json.dumps(CASE))
    at = table
    for name in place.split("."):
        at = at.setdefault(name, {"tangential_foundation_n_per_mm3": 1e4} if name == "seat" else {})
    at |= {each.field: each.boundary_value(facts[each.name]) for each in figures(kind) if each.name in facts}
    pair = gear_pair(Case.model_validate_json(json.dumps(table)))
    gear = pair.pinion
    assert isinstance(gear, Gear)
    read = {Material: gear.material, Shaft: pair.shafts[0], GearBlank: gear.blank}
    read |= {BoreSeat: gear.seat, Key: gear.seat.key}
    for each in figures(kind):
        value = getattr(kind(**facts), each.name)
        assert getattr(read[kind], each.name) == (None if value is None else pytest.approx(value, rel=1e-15))


@pytest.mark.parametrize(
    ("kind", "figure"),
    [(kind, each) for kind in BODIES for each in figures(kind)],
    ids=lambda one: getattr(one, "name", None) or one.__name__,
)
def test_a_body_is_refused_beyond_its_bound_by_case_and_library(kind, figure):
    place, facts = BODIES[kind]
    beyond = 1.01 * figure.what.bound.le
    with pytest.raises(InputError) as caught:
        kind(**facts | {figure.name: beyond})
    assert caught.value.field == figure.name
    assert case_field(f"pinion.{figure.name}") == f"pair.pinion.{figure.field}"
    table = json.loads(json.dumps(CASE))
    at = table
    for name in place.split("."):
        at = at.setdefault(name, {})
    at |= {each.field: each.boundary_value(facts[each.name]) for each in figures(kind) if each.name in facts}
    at[figure.field] = figure.boundary_value(beyond)
    with pytest.raises(ValidationError) as refused:
        Case.model_validate_json(json.dumps(table))
    assert figure.field in str(refused.value)


GEARS = {
    Gear: Gear(20, 4e-3, 25e-3, 40e-3),
    RingGear: RingGear(60, 4e-3, 25e-3, 0.28, addendum_coefficient=0.75),
}
OF_GEARS = pytest.mark.parametrize(
    ("kind", "figure"),
    [(kind, each) for kind in GEARS for each in figures(kind)],
    ids=lambda one: getattr(one, "name", None) or one.__name__,
)


def case_of(kind: type[Any]) -> tuple[dict[str, Any], str]:
    table = json.loads(json.dumps(CASE))
    if kind is Gear:
        return table, "pinion"
    ring = {"teeth": 60, "face_width_mm": 25.0, "internal": True, "rim_diameter_mm": 280.0}
    table["pair"] |= {"center_distance_mm": 79.8, "wheel": ring | {"addendum_coefficient": 0.75}}
    return table, "wheel"


@OF_GEARS
def test_a_gear_of_a_case_means_that_of_the_library(kind, figure):
    table, gear = case_of(kind)
    read = Case.model_validate_json(json.dumps(table)).pair
    value = getattr(getattr(gear_pair(Case.model_validate_json(json.dumps(table))), gear), figure.name)
    written = getattr(read if figure in SHARED else getattr(read, gear), figure.field)
    if figure.what.kind is Kind.CHOICE:
        assert value == written
        return
    assert value == (written if written is None else pytest.approx(written * figure.unit.factor, rel=1e-15))


@OF_GEARS
def test_a_gear_is_refused_beyond_its_bound_by_case_and_library(kind, figure):
    choice = figure.what.kind is Kind.CHOICE
    beyond = "no such name" if choice else type(figure.what.example)(2 * figure.what.bound.le)
    with pytest.raises(InputError) as caught:
        replace(GEARS[kind], **{figure.name: beyond})
    assert caught.value.field == figure.name
    assert str(caught.value.bound) == str(figure.what.limits)
    table, gear = case_of(kind)
    place = "pair" if figure in SHARED else f"pair.{gear}"
    assert case_field(f"{gear}.{figure.name}") == f"{place}.{figure.field}"
    at = table["pair"] if figure in SHARED else table["pair"][gear]
    at[figure.field] = figure.boundary_value(beyond)
    with pytest.raises(ValidationError) as refused:
        Case.model_validate_json(json.dumps(table))
    assert f"{place}.{figure.field}" in str(refused.value)


@pytest.mark.parametrize(("kind", "teeth"), [(Gear, 4), (Gear, 2000), (RingGear, 12), (RingGear, 4000)])
def test_a_case_takes_as_few_and_as_many_teeth_as_the_library(kind, teeth):
    table, gear = case_of(kind)
    table["pair"][gear]["teeth"] = teeth
    Case.model_validate_json(json.dumps(table))
    try:
        replace(GEARS[kind], teeth=teeth)
    except InputError as error:  # it may be infeasible, but not by this
        assert error.field != "teeth"


def test_a_pair_is_refused_beyond_its_largest_center_distance_by_case_and_library():
    (figure,) = figures(GearPair)
    with pytest.raises(InputError) as caught:
        GearPair(GEARS[Gear], GEARS[Gear], 2 * figure.what.bound.le)
    assert (caught.value.field, caught.value.bound) == ("center_distance", figure.what.limits)
    table = json.loads(json.dumps(CASE))
    table["pair"]["center_distance_mm"] = figure.boundary_value(2 * figure.what.bound.le)
    with pytest.raises(ValidationError) as refused:
        Case.model_validate_json(json.dumps(table))
    assert "pair.center_distance_mm" in str(refused.value)


def test_design_variables_and_scatter_are_depths_and_lengths():
    free = [each.field for each in FIGURES if each.name in QUANTITIES]
    assert list(GearVariablesInput.model_fields) == list(GearScatterInput.model_fields) == free
    kinds = {each.what.kind for each in FIGURES if each.name in QUANTITIES}
    assert kinds == {Kind.AMOUNT, Kind.DEVIATION, Kind.LENGTH}
    assert set(ACROSS_FACE) == {
        each.name for each in FIGURES if each.name in QUANTITIES and Direction.FACE in each.what.along
    }


CORNERS = {"triangular_tip_relief", "triangular_root_relief"}


def pair_with(figure: Figure, scale: float = 1.0) -> GearPair:
    """Return a pair whose pinion has a figure alone; spur gears have no corners to relieve."""
    gear = Gear(20, 4e-3, 25e-3, 40e-3, helix_angle=0.2 if figure.name in CORNERS else 0.0)
    facts = with_length(figure)
    facts[figure.name] *= scale
    mate = replace(gear, helix_angle=-gear.helix_angle)
    return GearPair(replace(gear, modification=FlankModification(**facts)), mate)


@DEPTHS
def test_a_depth_too_small_to_be_made_is_implausible(figure):
    assert not pair_findings(pair_with(figure))
    found = [finding.field for finding in pair_findings(pair_with(figure, 1e-3))]
    assert found == [f"pinion.{figure.name}"]


@DEPTHS
def test_a_plane_refuses_what_acts_across_the_face(figure):
    if Direction.FACE not in figure.what.along or figure.name in CORNERS:
        return
    with pytest.raises(InputError) as caught:
        analyze(pair_with(figure), torques=[100.0], model="plane_strain")
    assert caught.value.field == f"pinion.modification.{figure.name}"
