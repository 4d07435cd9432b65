"""REXS units with something gone or bent: opened, or one error."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from lineofaction.gearbox.from_rexs.opened import opened, unit_files
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Document
from tests.fakes.rexs_unit import (
    STAGES,
    planetary,
    two_stages,
)


def _without(document: Document, seed: int) -> Document:
    """Return a document with an attribute or a relation gone, a unit swapped, or a value bent."""
    random = np.random.default_rng(seed)
    model = document.model
    relations, components = list(model.relations), list(model.components)
    kind = int(random.integers(4))
    if kind == 0:
        relations.pop(int(random.integers(len(relations))))
    else:
        index = int(random.choice([n for n, part in enumerate(components) if part.attributes]))
        values = list(components[index].attributes)
        at = int(random.integers(len(values)))
        bent: list[Any] = [-1.0, 0.0, 1e300, math.nan, True, "x", (), (1.0, 2.0), None]
        if kind == 1:
            values.pop(at)
        elif kind == 2:
            values[at] = type(values[at])(**{**vars(values[at]), "unit": "kW"})
        else:
            value = bent[int(random.integers(len(bent)))]
            values[at] = type(values[at])(**{**vars(values[at]), "value": value})
        components[index] = type(components[index])(
            **{**vars(components[index]), "attributes": tuple(values)}
        )
    changed = {**vars(model), "relations": tuple(relations), "components": tuple(components)}
    return Document(type(model)(**changed))


@pytest.mark.law
@pytest.mark.parametrize("make", [two_stages, planetary])
@pytest.mark.parametrize("seeds", [40, pytest.param(80, marks=pytest.mark.nightly)])
def test_a_damaged_unit_is_opened_or_refused_with_one_error(make: Any, seeds: int) -> None:
    whole, refused, changed = opened(make()), 0, 0
    for seed in range(seeds):
        try:
            unit = opened(_without(make(), seed))
        except BadInput as error:
            refused += 1
            assert len(str(error)) < 2_000
        else:
            changed += unit.lines != whole.lines
            json.dumps(unit_files(unit))
    assert refused >= seeds // 40 and changed > seeds // 3


@pytest.mark.parametrize("stage", STAGES)
def test_a_stage_without_a_gear_leaves_the_other(stage: int) -> None:
    unit = opened(two_stages({11 if stage == STAGES[0] else 13: {"number_of_teeth": None}}))
    assert [case.stage for case in unit.cases] == [other for other in STAGES if other != stage]
