"""The keywords of `analyze` are the members of its axes, options and run, with their types."""

from dataclasses import fields
from typing import Any, get_type_hints

import pytest

from fe_contact import AnalysisOptions, Gear, GearPair, Run, TableAxes, analyze
from fe_contact.errors import InputError
from fe_contact.keywords import TableKeywords, with_keywords

RECORDS = (TableAxes, AnalysisOptions, Run)
GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
PAIR = GearPair(GEAR, GEAR, 80e-3)


def test_every_member_is_a_keyword_of_its_type():
    members: dict[str, Any] = {}
    for record in RECORDS:
        hints = get_type_hints(record)
        members |= {field.name: hints[field.name] for field in fields(record)}
    keywords = get_type_hints(TableKeywords)
    assert keywords == members | {"tolerance": members["tolerance"] | float}


def test_a_keyword_replaces_the_member_of_its_record():
    axes, options = TableAxes([1.0, 2.0], pitches=3), AnalysisOptions(model="3d")
    changed = with_keywords(axes, options, Run(), {"torques": [5.0], "tolerance": 0.02, "level": None})
    assert changed[0] == TableAxes([5.0], pitches=3)
    assert changed[1].model == "3d"
    assert changed[1].tolerance.relative == 0.02
    assert changed[2] == Run()


def test_a_keyword_that_is_none_is_refused():
    with pytest.raises(TypeError, match="no keyword 'torque'"):
        analyze(PAIR, torque=[100.0])


def test_a_pair_without_loads_is_refused_by_their_field():
    with pytest.raises(InputError, match="torques"):
        analyze(PAIR, level="draft")
