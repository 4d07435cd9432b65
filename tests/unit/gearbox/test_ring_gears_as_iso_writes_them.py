"""Ring gears with the negative teeth, diameters and center distance of ISO 21771-1."""

import tomllib
from pathlib import Path

import pytest

from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated

CASE = tomllib.loads((Path(__file__).parents[3] / "examples" / "internal_gear.toml").read_text("utf-8"))


def _negative(**wheel: object) -> dict[str, object]:
    pair = CASE["pair"]
    ring = {name: value for name, value in pair["wheel"].items() if name != "internal"}
    changed = {**ring, "teeth": -96, "rim_diameter_mm": -212.0, **wheel}
    return {**CASE, "pair": {**pair, "center_distance_mm": -60.0, "wheel": changed}}


@pytest.mark.law
def test_a_ring_gear_of_negative_teeth_is_the_one_of_positive_teeth():
    written = validated(Case, _negative())
    assert gear_pair(written) == gear_pair(validated(Case, CASE))
    assert written.pair.wheel.internal and written.pair.wheel.teeth == 96


def test_a_pinion_has_no_negative_teeth():
    pair = CASE["pair"]
    with pytest.raises(BadInput, match="teeth"):
        validated(Case, {**CASE, "pair": {**pair, "pinion": {**pair["pinion"], "teeth": -36}}})
