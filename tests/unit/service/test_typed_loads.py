"""Loads and alignments of an answer are those that were typed."""

from __future__ import annotations

import pytest

from fe_contact import SteDatabase, analyze
from lineofaction.gearbox.convert.answers import metadata_json, summary_json
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.schemas import Case
from service.schemas.examples import CASE

TORQUES = [30.0, 60.0, 110.0, 230.0]


@pytest.fixture(scope="module")
def table() -> SteDatabase:
    pair = gear_pair(Case.model_validate(CASE))
    return analyze(pair, torques=TORQUES, level="draft", positions=8, model="plane_strain")


def test_torques_come_back_as_they_were_typed(table: SteDatabase) -> None:
    """The table holds forces: torque to force and back leaves a last digit."""
    assert table.torque.tolist() != TORQUES
    assert metadata_json(table)["torque_n_m"] == TORQUES
    assert [load["torque_n_m"] for load in summary_json(table)["loads"]] == TORQUES
