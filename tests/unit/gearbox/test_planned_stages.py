"""The plan of a study has its work in the stages in which it is done."""

import tomllib
from importlib import import_module
from typing import Any

import pytest
from spur_case import spur_case

from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.studies.computation import Means

pair_contact = import_module("fe_contact.analysis.pairs.pair_contact")

PLANE = {"model": "plane_strain"}
STUDIED: dict[str, dict[str, Any]] = {
    "flank": {},
    "root-stress": {},
    "scatter": {"samples": 8, "exact": 8},
    "optimize": {"search": {"trials": 0, "evaluations": 2, "sample": 0}},
}
"""Inputs of the studies that condense gears, as small as they may be."""


@pytest.mark.parametrize("name", STUDIED)
def test_gears_are_planned_in_the_stage_in_which_they_are_condensed(name, tmp_path, monkeypatch):
    """Coarse gears too, which yield the error of the mesh: the stage that is reported next has done them."""
    study = STUDIES[name]
    case = CheckedCase(validated(Case, tomllib.loads(spur_case(torques=[100.0], **PLANE))))
    inputs = validated(study.inputs, STUDIED[name])
    events: list[str] = []
    condensed = pair_contact.flank_compliances

    def recorded(*arguments: Any, **options: Any) -> Any:
        events.append("condensed")
        return condensed(*arguments, **options)

    monkeypatch.setattr(pair_contact, "flank_compliances", recorded)
    subject = study.run.narrowed(case, inputs)
    parts = {part.name: part for part in study.run.predicted(subject, inputs, tmp_path).parts}
    study.run.compute(subject, inputs, Means(tmp_path, lambda stage, _: events.append(stage)))
    stages = [
        next(event for event in events[place:] if event != "condensed")
        for place, event in enumerate(events)
        if event == "condensed"
    ]
    assert stages[0] == parts["gears"].stage
    assert stages[1] == parts["coarse gears"].stage
