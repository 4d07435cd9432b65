"""The effect ledger: every effect with its decision, influence, cost, price and check."""

import json
from dataclasses import replace

import pytest
from analysis_requests import table_request
from spur_gears import GEAR

from fe_contact import AnalysisOptions, FlankModification, GearPair, PitchDeviation, Shaft, TableAxes, analyze
from fe_contact.analysis.checks.effect_ledger import effect_ledger
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.run_plan import plan_run
from fe_contact.effects import EFFECTS
from fe_contact.types import Json

FULL = replace(
    GEAR,
    modification=FlankModification(tip_relief=5e-6, tip_relief_length=1e-3, helix_crowning=5e-6),
    pitch_deviation=PitchDeviation((4e-6, *([0.0] * 19))),
)
SHAFT = Shaft(length=0.2, diameter=0.04, position=0.06)
PLAIN, EVERYTHING = GearPair(GEAR, GEAR), GearPair(FULL, GEAR, shafts=(SHAFT, None))
FIELDS = {
    "name", "on", "choice", "called_for", "reason", "decision", "influence", "cost",
    "cost_cpu_seconds", "price", "checked", "holds",
}  # fmt: skip


def ledger(pair: GearPair, **asked: object) -> dict[str, Json]:
    """Entries by name, before anything is computed."""
    checked = check_request(pair, *table_request(**{"torques": [100.0], "positions": 16} | asked))
    return {entry["name"]: entry for entry in effect_ledger(checked, None)}


@pytest.mark.law
@pytest.mark.parametrize(
    ("pair", "asked"),
    [
        (PLAIN, {}),
        (EVERYTHING, {"misalignments": [10e-6]}),
        (PLAIN, {"model": "plane_strain", "tolerance": 0.01}),
        (PLAIN, {"effects": dict.fromkeys(("tooth_coupling", "corner_contact"), "off")}),
    ],
)
def test_every_effect_has_every_field(pair, asked):
    found = ledger(pair, **asked)
    assert list(found) == [effect.name for effect in EFFECTS]
    for entry in found.values():
        assert set(entry) == FIELDS
        assert all(entry[name] for name in ("reason", "decision", "cost", "checked"))
        if entry["on"] or entry["called_for"]:
            assert entry["influence"] is not None or entry["name"] == "face_load_distribution"
            assert entry["cost_cpu_seconds"] is not None or entry["name"] == "face_load_distribution"
    json.dumps(found, allow_nan=False)


def test_a_choice_against_the_scene_is_obeyed_and_has_a_price():
    off = ledger(PLAIN, effects={"tooth_coupling": "off"})["tooth_coupling"]
    assert not off["on"]
    assert off["decision"] == "as requested, although the scene calls for it"
    assert off["price"] == off["influence"]["words"]
    assert -0.06 < off["influence"]["relative_mean"] < -0.05  # docs/effects.md#tooth_coupling
    on = ledger(PLAIN, effects={"face_load_distribution": "on"})["face_load_distribution"]
    assert on["on"]
    assert on["cost_cpu_seconds"] > 0.1
    assert on["price"].endswith("CPU s")
    assert all(entry["price"] == "" for entry in ledger(PLAIN).values())


def test_three_dimensions_cost_what_the_plan_says(tmp_path):
    axes = TableAxes(torques=[100.0])
    flat, solid = (
        plan_run(PLAIN, axes, AnalysisOptions(model=model, positions=16), cache=tmp_path)
        for model in ("auto", "3d")
    )
    found = {entry["name"]: entry for entry in solid.to_json()["effect_ledger"]}
    extra = solid.chosen.cost.cpu_seconds - flat.chosen.cost.cpu_seconds
    assert found["face_load_distribution"]["cost_cpu_seconds"] == pytest.approx(extra, rel=1e-6)


def test_a_minimal_receipt_estimates_neither_influence_nor_cost():
    table = analyze(PLAIN, torques=[100.0], level="draft", positions=16, receipt="minimal")
    for entry in table.metadata.effect_ledger:
        assert set(entry) == FIELDS
        assert entry["influence"] is None
        assert entry["cost_cpu_seconds"] is None
