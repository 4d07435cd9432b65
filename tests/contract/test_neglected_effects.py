"""An effect that is off is one that is not there: bit by bit, in both libraries."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, PitchDeviation, Shaft, SteDatabase, analyze
from fe_contact.analysis.request import request
from fe_contact.effects import EFFECTS
from fe_contact.types import Json

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=20e-3, bore_diameter=40e-3)
MODIFIED = FlankModification(
    tip_relief=5e-6, tip_relief_length=1e-3, helix_crowning=5e-6, tip_rounding=0.1e-3
)
ERRING = PitchDeviation((4e-6, *([0.0] * 19)))
SHAFT = Shaft(length=0.2, diameter=0.04, position=0.06)
ALL_OVER_THE_FACE = GearPair(
    replace(GEAR, modification=MODIFIED, pitch_deviation=ERRING), GEAR, shafts=(SHAFT, None)
)
IN_THE_PLANE = GearPair(replace(GEAR, modification=MODIFIED.along_profile), GEAR)
SCENES: dict[str, tuple[GearPair, Json]] = {
    "plane": (IN_THE_PLANE, {}),
    "face": (ALL_OVER_THE_FACE, {"misalignments": [20e-6], "pitches": 2}),
}


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("compliance")


def table(scene: str, cache: Path, effects: dict[str, str]) -> SteDatabase:
    pair, asked = SCENES[scene]
    asked = {"normal_forces": [1000.0, 3000.0], "level": "draft", "positions": 8} | asked
    return analyze(pair, **asked, effects=effects, receipt="minimal", cache=cache, on_violation="report")


def arrays(found: SteDatabase) -> Iterator[tuple[str, np.ndarray]]:
    for name, values in vars(found).items():
        if isinstance(values, np.ndarray):
            yield name, values


@pytest.mark.law
@pytest.mark.parametrize("scene", list(SCENES))
@pytest.mark.parametrize("name", [effect.name for effect in EFFECTS])
def test_a_table_with_an_effect_off_is_that_of_a_build_without_it(
    scene: str, name: str, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if scene == "face" and name == "face_load_distribution":
        pytest.skip("no plane holds what acts across the face")
    off = table(scene, cache, {name: "off"})
    remaining = tuple(effect for effect in EFFECTS if effect.name != name)
    monkeypatch.setattr(request, "EFFECTS", remaining)
    without = table(scene, cache, {})
    assert name not in {entry["name"] for entry in without.metadata.effect_ledger}
    compared = 0
    for field, values in arrays(without):
        np.testing.assert_array_equal(getattr(off, field), values, err_msg=field)
        compared += values.size
    assert compared > 100


def test_the_registry_goes_with_the_request() -> None:
    """A module that reads the registry by itself would escape the test above."""
    folder = Path(request.__file__).parent
    reading = {file.stem for file in folder.rglob("*.py") if "EFFECTS" in file.read_text()}
    assert reading - {"ablation", "condensed_lookup", "sensitivity"} == {"request"}  # those read names
