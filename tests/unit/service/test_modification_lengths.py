"""A modification over a part of the flank needs the length of that part.

The schema does not state it: generators multiply a dozen conditions out, and take the description of none.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from bounds import Kind
from fe_contact.flank.modification import FlankModification
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.declared import figures

FILE = Path(__file__).parents[3] / "examples" / "wind_turbine_high_speed.toml"
FIELDS = {figure.name: figure.field for figure in figures(FlankModification)}
LENGTH_OF = {
    FIELDS[length.name.removesuffix("_length")]: length.field
    for length in figures(FlankModification, Kind.LENGTH)
}


def taken(case: dict[str, Any]) -> bool:
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
def test_an_amount_is_taken_with_its_length(amount: str, given: dict[str, float], whole: bool) -> None:
    case = tomllib.loads(FILE.read_text("utf-8"))
    names = {"amount": amount, "length": LENGTH_OF[amount]}
    case["pair"]["pinion"] |= {names[part]: value for part, value in given.items()}
    assert taken(case) == whole
