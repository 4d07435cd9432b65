"""``loa optimize``: tables, files of every kind, and a design that the case file takes as it is."""

import json
from contextlib import contextmanager

import pytest
from command_line import loa
from spur_case import spur_case

from lineofaction.gearbox.schemas import Case, read_model

CASE = spur_case("{pinion}", "{wheel}", [100.0, 200.0], model="plane_strain")
STUDY = """
[variables.pinion]
tip_relief_um = [0, 40]
tip_relief_length_mm = [0.5, 3.0]
[variables.wheel]
tip_relief_um = [0, 40]
tip_relief_length_mm = [0.5, 3.0]
[scatter]
points = 2
wheel = { profile_slope_um = 2.0 }
[search]
evaluations = 24
positions = 16
"""


@pytest.fixture
def files(tmp_path):
    case, study = tmp_path / "case.toml", tmp_path / "study.toml"
    case.write_text(CASE.format(pinion="", wheel=""), encoding="utf-8")
    study.write_text(STUDY, encoding="utf-8")
    return case, study


def test_all_files_say_the_same(files, tmp_path):
    folder = tmp_path / "optimum"
    ran = loa("optimize", *files, "-o", folder)
    assert ran.exit_code == 0, ran.output
    told = json.loads((folder / "optimum.json").read_text(encoding="utf-8"))
    assert told["outcome"] == "improved"
    assert "improved: expected peak-to-peak falls by" in ran.output
    assert told["gain_um"] > told["gain_error_um"]
    assert told["nodes"]["deviation"] == [[-2.0], [2.0]]
    before, best = (read_model(Case, file) for file in (files[0], folder / "optimum.toml"))
    assert set(told["optimum"]["values"]) == {"pinion", "wheel"}
    for gear, values in told["optimum"]["values"].items():
        assert 0.0 <= values["tip_relief_um"] <= 40.0 and 0.5 <= values["tip_relief_length_mm"] <= 3.0
        chosen = getattr(best.pair, gear).model_dump()
        assert {name: chosen[name] for name in values} == pytest.approx(values, rel=1e-5)
        plain = getattr(before.pair, gear).model_dump()
        assert {name for name in chosen if chosen[name] != plain[name]} <= set(values)
    assert best.model_copy(update={"pair": before.pair}) == before
    page = (folder / "optimum.html").read_text(encoding="utf-8")
    assert "Harris map after" in page and "every node of the scatter" in page


def test_the_design_in_the_case_file_has_the_ripple_that_was_told(files, tmp_path):
    case, study = files
    study.write_text(STUDY.replace("profile_slope_um = 2.0", ""), encoding="utf-8")
    best = tmp_path / "best.toml"
    ran = loa("optimize", case, study, "-o", best, "--json")
    assert ran.exit_code == 0, ran.output
    told = json.loads(ran.output)
    table = tmp_path / "ste.nc"
    analyzed = loa("analyze", best, "-o", table, "--json")
    assert analyzed.exit_code == 0, analyzed.output
    harris = told["optimum"]["harris_map"]
    for torque in (100.0, 200.0):
        asked = ["ste", str(table), "--torque", str(torque), "--json"]
        curve = json.loads(loa(*asked).output)
        index = harris["torque_n_m"].index(torque)
        allowed = curve["peak_to_peak_error_um"]
        assert abs(harris["expected_peak_to_peak_um"][index] - curve["peak_to_peak_um"]) <= allowed


def test_an_interrupted_search_writes_its_best_and_says_so(files, tmp_path, monkeypatch):
    asked = [0]

    @contextmanager
    def interrupted_after_twelve():
        def cancel():
            asked[0] += 1
            return asked[0] > 13  # once before the start

        yield cancel

    monkeypatch.setattr("lineofaction.cli.run_study.until_interrupted", interrupted_after_twelve)
    ran = loa("optimize", *files, "-o", tmp_path / "best.json")
    assert ran.exit_code == 130, ran.output
    told = json.loads((tmp_path / "best.json").read_text(encoding="utf-8"))
    assert told["evaluations"] == 12 and told["runs"][0]["ended"] == "interrupted"
    assert "interrupted after 12 of at most 24 designs" in " ".join(ran.output.split())
    assert "not tried: " in ran.output
