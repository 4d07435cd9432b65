"""A declared figure is at every door: case, live question, design variable, scatter, names in messages."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from typing import Any

import pytest

from bounds import Direction, Kind
from fe_contact.analysis import analyze
from fe_contact.errors import InputError
from fe_contact.flank.modification import FlankModification
from fe_contact.geometry import Gear, GearPair
from fe_contact.microgeometry import QUANTITIES
from fe_contact.microgeometry.variables import ACROSS_FACE
from fe_contact.plausibility import pair_findings
from service.convert.case import gear_pair
from service.convert.vocabulary import boundary_name
from service.schemas import Case
from service.schemas.declared import Figure, figures
from service.schemas.live import LiveInput
from service.schemas.optimisation import GearScatterInput, GearVariablesInput
from service.schemas.request_examples import CASE

FIGURES = figures(FlankModification)
EVERY = pytest.mark.parametrize("figure", FIGURES, ids=[figure.name for figure in FIGURES])
DEPTHS = pytest.mark.parametrize(
    "figure",
    [figure for figure in FIGURES if figure.what.kind in (Kind.AMOUNT, Kind.SLOPE)],
    ids=lambda figure: figure.name,
)


def with_length(figure: Figure) -> dict[str, Any]:
    """Return the example of a figure in SI, with that of its length, or of the amount whose length it is."""
    names = {figure.name, f"{figure.name}_length", figure.name.removesuffix("_length")}
    return {each.name: each.what.example for each in FIGURES if each.name in names}


def as_written(facts: dict[str, Any]) -> dict[str, Any]:
    """Return figures as a case has them."""
    return {each.field: each.own(facts[each.name]) for each in FIGURES if each.name in facts}


def test_all_but_the_grid_are_declared_numbers_or_names() -> None:
    assert {entry.name for entry in fields(FlankModification)} - {figure.name for figure in FIGURES} == {
        "flank_grid"
    }


@EVERY
def test_a_case_and_the_library_mean_the_same(figure: Figure) -> None:
    facts = with_length(figure)
    table = json.loads(json.dumps(CASE))
    table["pair"]["pinion"] |= as_written(facts)
    case = Case.model_validate_json(json.dumps(table))
    read, meant = gear_pair(case).pinion.modification, FlankModification(**facts)
    for each in FIGURES:
        value = getattr(meant, each.name)
        near = pytest.approx(value, rel=1e-15) if isinstance(value, float) else value
        assert getattr(read, each.name) == near, each.name
    assert figure.own(figure.default) == getattr(case.pair.wheel, figure.field)


@EVERY
def test_the_schema_has_the_bound_of_the_library(figure: Figure) -> None:
    schema = Case.model_json_schema()["$defs"]["GearInput"]["properties"][figure.field]
    if figure.what.kind is Kind.SHAPE:
        assert tuple(schema["enum"]) == figure.what.bound.names
        return
    for end in (schema["minimum"], schema["maximum"]):
        value = end * figure.unit.factor
        assert figure.what.bound.holds(value)
        beyond = value + (1e-9 if end == schema["maximum"] else -1e-9)
        with pytest.raises(InputError) as caught:
            FlankModification(**{figure.name: beyond})
        assert caught.value.field == figure.name


@EVERY
def test_it_can_be_changed_live_and_is_told_by_its_own_name(figure: Figure) -> None:
    change = as_written(with_length(figure))
    question = LiveInput.model_validate_json(json.dumps({"torque_n_m": [1.0], "pinion": change}))
    assert question.pinion.model_dump(exclude_none=True) == change
    assert boundary_name(f"pinion.{figure.name}") == f"pinion.{figure.field}"


def test_design_variables_and_scatter_are_depths_and_lengths() -> None:
    free = [each.field for each in FIGURES if each.name in QUANTITIES]
    assert list(GearVariablesInput.model_fields) == list(GearScatterInput.model_fields) == free
    kinds = {each.what.kind for each in FIGURES if each.name in QUANTITIES}
    assert kinds == {Kind.AMOUNT, Kind.SLOPE, Kind.LENGTH}
    assert set(ACROSS_FACE) == {
        each.name for each in FIGURES if each.name in QUANTITIES and Direction.FACE in each.what.along
    }


def pair_with(figure: Figure, scale: float = 1.0) -> GearPair:
    """Return a pair whose pinion has a figure alone."""
    gear = Gear(20, 4e-3, 25e-3, 40e-3)
    facts = with_length(figure)
    facts[figure.name] *= scale
    return GearPair(replace(gear, modification=FlankModification(**facts)), gear, 80e-3)


@DEPTHS
def test_a_depth_too_small_to_be_made_is_implausible(figure: Figure) -> None:
    assert not pair_findings(pair_with(figure))
    found = [finding.field for finding in pair_findings(pair_with(figure, 1e-3))]
    assert found == [f"pinion.{figure.name}"]


@DEPTHS
def test_a_plane_refuses_what_acts_across_the_face(figure: Figure) -> None:
    if Direction.FACE not in figure.what.along:
        return
    with pytest.raises(InputError) as caught:
        analyze(pair_with(figure), torques=[100.0], model="plane_strain")
    assert caught.value.field == f"pinion.modification.{figure.name}"
