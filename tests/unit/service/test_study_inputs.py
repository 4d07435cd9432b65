"""What a study takes besides its subject: a table, models in it, or its file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from lineofaction.client.offers import offers
from lineofaction.gearbox.from_rexs.opened import opened, unit_files, unit_json
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import read_rexs
from lineofaction.gearbox.studies.deflect import Inputs
from service.schemas.answers import UnitBody

UNIT = Path(__file__).parents[3] / "examples" / "two_stage_gearbox.rexs"
ROTOR = UNIT.with_name("jeffcott_scene.toml")


def test_load_cases_of_an_opened_unit_are_those_of_their_file(tmp_path: Path) -> None:
    unit = opened(read_rexs(UNIT))
    body = UnitBody.model_validate(unit_json(unit))
    file = tmp_path / "load_cases.toml"
    file.write_text(unit_files(unit)["load_cases.toml"], encoding="utf-8")
    deflect = offers()["deflect"]
    by_model, by_file = (
        deflect.inputs(body.scene, study) for study in ({"load_cases": body.load_cases}, file)
    )
    assert by_model == json.loads(json.dumps(by_model))
    as_model, as_file = (
        Inputs.model_validate_json(json.dumps({"load_cases": given["load_cases"]}))
        for given in (by_model, by_file)
    )
    assert as_model == as_file
    assert [case["torque_n_m"] for case in by_model["load_cases"]] == [50.0, 80.0, 30.0]


def test_a_path_as_text_is_refused_with_what_to_do() -> None:
    with pytest.raises(BadInput, match=r"pathlib\.Path"):
        offers()["deflect"].inputs(ROTOR, "load_cases.toml")
