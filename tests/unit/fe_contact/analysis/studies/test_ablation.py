"""Effects toggled one by one: the changes are those of the tables, beside their estimates."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import FlankModification, Gear, GearPair, PitchDeviation, ablate, analyze
from fe_contact.analysis.database.compute_database import compute_database
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.studies import ablation
from fe_contact.analysis.studies.ablation import Ablation
from fe_contact.errors import InputError
from fe_contact.options import Run, TableAxes
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.studies.ablate.run import RUN

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
RELIEVED = replace(GEAR, modification=FlankModification(tip_relief=15e-6, tip_relief_length=1.2e-3))
PAIR = GearPair(RELIEVED, GEAR)
ASKED = {"normal_forces": [800.0, 2500.0], "level": "draft", "positions": 64}


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("compliance")


@pytest.fixture(scope="module")
def made(cache: Path) -> Ablation:
    only = ["tooth_coupling", "corner_contact", "profile_modification", "finite_width", "misalignment"]
    return ablate(PAIR, *table_request(**ASKED), run=Run(cache=cache), only=only)  # type: ignore[arg-type]


def test_a_change_is_that_of_two_tables(made: Ablation, cache: Path) -> None:
    effects = {"tooth_coupling": "off"}
    whole, without = (analyze(PAIR, **ASKED, effects=e, cache=cache) for e in ({}, effects))  # type: ignore[arg-type]
    entry = next(one for one in made.effects if one.name == "tooth_coupling")
    assert entry.on
    for k, force in enumerate(whole.force):
        curves = [table.curve(force=float(force)) for table in (whole, without)]
        assert made.nominal.mean[k] == curves[0].mean.value
        assert entry.mean_change[k] == curves[1].mean.value - curves[0].mean.value
        assert entry.peak_to_peak_change[k] == curves[1].peak_to_peak.value - curves[0].peak_to_peak.value
        first = curves[1].harmonics[0].value - curves[0].harmonics[0].value
        assert entry.harmonic_change[k, 0] == pytest.approx(first, rel=1e-12, abs=0.0)


def test_estimates_are_within_a_factor_of_two(made: Ablation) -> None:
    for entry in made.effects:
        estimate, measured = entry.estimate, made.measured(entry)
        assert estimate is not None
        assert (estimate.torque, estimate.misalignment) == (measured.torque, measured.misalignment)
        for name in ("mean", "peak_to_peak"):
            if abs(getattr(measured, f"relative_{name}")) > 0.01:
                ratio = getattr(estimate, name) / getattr(measured, name)
                assert 0.5 < ratio < 2.0, (entry.name, ratio)


def test_what_the_scene_does_not_hold_is_left_out_by_name(made: Ablation) -> None:
    assert made.left_out == {"misalignment": "the gears are aligned"}
    assert [entry.name for entry in made.effects] == [
        "tooth_coupling", "corner_contact", "profile_modification", "finite_width",
    ]  # fmt: skip


def test_an_effect_that_is_off_is_switched_on(cache: Path, made: Ablation) -> None:
    off = ablate(
        PAIR,
        *table_request(effects={"tooth_coupling": "off"}, **ASKED),
        run=Run(cache=cache),
        only=["tooth_coupling"],
    )  # type: ignore[arg-type]
    (entry,) = off.effects
    (usual,) = [one for one in made.effects if one.name == "tooth_coupling"]
    assert not entry.on
    np.testing.assert_array_equal(entry.mean_change, usual.mean_change)
    np.testing.assert_array_equal(off.nominal.mean, usual.without_effect.mean)


def test_longer_periods_cost_more(cache: Path) -> None:
    early = PitchDeviation((3e-6, *([0.0] * 19)))
    pair = GearPair(replace(GEAR, pitch_deviation=early), GEAR)
    (entry,) = ablate(pair, *table_request(**ASKED), run=Run(cache=cache), only=["pitch_error"]).effects  # type: ignore[arg-type]
    # twenty base pitches to solve instead of one, over the same finite elements
    assert entry.with_effect.predicted_cpu_seconds > entry.without_effect.predicted_cpu_seconds + 0.01
    assert entry.cost_ratio > 1.0


def test_what_no_plane_holds_stays_in(cache: Path) -> None:
    asked = ASKED | {"misalignments": [10e-6], "positions": 16}
    made = ablate(
        GearPair(GEAR, GEAR), *table_request(**asked), run=Run(cache=cache), only=["face_load_distribution"]
    )  # type: ignore[arg-type]
    assert made.effects == ()
    assert "misalignments" in made.left_out["face_load_distribution"]


def test_the_result_is_plain_json(made: Ablation) -> None:
    written = json.loads(json.dumps(RUN.figures(made), allow_nan=False))
    assert written["effects"][0]["estimate"]["mean_um"] == made.effects[0].estimate.mean / 1e-6


def test_an_unknown_effect_is_refused() -> None:
    with pytest.raises(InputError, match="only"):
        ablate(PAIR, TableAxes(normal_forces=[1000.0]), only=["windage"])


def test_a_tolerance_chooses_one_mesh_for_all_tables(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = []

    def noted(checked: Checked, *further: object) -> SteDatabase:
        made.append((checked.request.options.level, checked.request.options.tolerance))
        return compute_database(checked, *further)  # type: ignore[arg-type]

    monkeypatch.setattr(ablation, "compute_database", noted)
    asked = {"normal_forces": [2500.0], "tolerance": 0.05, "positions": 16}
    found = ablate(PAIR, *table_request(**asked), run=Run(cache=cache), only=["tooth_coupling"])
    assert len(found.effects) == 1
    assert made == [("draft", None)] * 2
