"""A modification over a part of the flank needs the length of that part: schema and model say the same."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from service.convert.case import gear_pair
from service.problems import BadInput
from service.schemas import Case, validated
from service.schemas.gear import OVER_LENGTHS

FILE = Path(__file__).parents[3] / "examples" / "wind_turbine_high_speed.toml"
LENGTH_OF = {rule["if"]["required"][0]: rule["then"]["required"][0] for rule in OVER_LENGTHS}
SCHEMA = Case.model_json_schema()


def taken(case: dict[str, Any]) -> bool:
    """Return whether the model takes a case."""
    try:
        gear_pair(validated(Case, case))
    except BadInput:
        return False
    return True


@pytest.mark.parametrize("amount", LENGTH_OF)
@pytest.mark.parametrize(
    ("given", "whole"),
    [({"amount": 0.0}, True), ({"amount": 5.0}, False), ({"amount": 5.0, "length": 0.5}, True)],
)
def test_schema_and_model_ask_for_the_length(amount: str, given: dict[str, float], whole: bool) -> None:
    case = tomllib.loads(FILE.read_text("utf-8"))
    names = {"amount": amount, "length": LENGTH_OF[amount]}
    case["pair"]["pinion"] |= {names[part]: value for part, value in given.items()}
    assert jsonschema.Draft202012Validator(SCHEMA).is_valid(case) == taken(case) == whole
