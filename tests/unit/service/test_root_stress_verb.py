"""``loa root-stress``: table, CSV and JSON say the same; refusals."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest
from spur_case import SPUR
from typer.testing import CliRunner, Result

from lineofaction.cli.commands import app
from lineofaction.gearbox.convert.case import CheckedCase, case_at
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.root_stress import Inputs
from lineofaction.gearbox.studies.root_stress.run import RUN
from lineofaction.report.flank.root_stress import _root_stress_figure

CASE = (
    SPUR
    + """
[load]
torque_n_m = [50, 100]
[accuracy]
level = "draft"
"""
)


def loa(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["root-stress", *(str(argument) for argument in arguments)])


@pytest.fixture
def case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    file = tmp_path / "case.toml"
    file.write_text(CASE)
    return file


def test_table_csv_json_and_picture_say_the_same(case: Path, tmp_path: Path) -> None:
    as_json, as_csv, shown = loa(case, "--json"), loa(case, "--csv"), loa(case)
    assert [(r.exit_code, r.stderr) for r in (as_json, as_csv, shown)] == [(0, "")] * 3
    found = json.loads(as_json.stdout)
    assert found["torque_n_m"] == pytest.approx(100.0)  # the highest load of the case
    lines = list(csv.DictReader(io.StringIO(as_csv.stdout)))
    for gear in ("pinion", "wheel"):
        tension, passage = found[gear]["tension"], found[gear]["passage"]
        assert tension["stress_mpa"] == pytest.approx(73.0, rel=0.03)  # 25 MPa of F_t/(b m) by 1.71 by 1.78
        assert max(passage["tension_mpa"]) == tension["stress_mpa"]
        assert min(passage["compression_mpa"]) == found[gear]["compression"]["stress_mpa"] < 0.0
        assert 0.0 < tension["error_mpa"] < 0.03 * tension["stress_mpa"]
        assert 30.0 < tension["tangent_angle_deg"] < 40.0
        mine = [line for line in lines if line["gear"] == gear]
        assert [float(line["position"]) for line in mine] == passage["position"]
        written = [float(line["tension_mpa"]) for line in mine]
        assert written == pytest.approx(passage["tension_mpa"], rel=1e-5, abs=1e-9)
        (row,) = [r for r in shown.stdout.splitlines() if r.split()[:2] == [gear, "tension"]]
        assert f"{tension['stress_mpa']:.4g} ±" in row
    picture = case.parent / "root.png"
    half = json.loads(loa(case, "--torque", "50", "--image", picture, "--json").stdout)
    assert half["pinion"]["tension"]["stress_mpa"] == pytest.approx(
        0.5 * found["pinion"]["tension"]["stress_mpa"], rel=0.02
    )
    assert picture.read_bytes().startswith(b"\x89PNG")
    alone = CheckedCase(case_at(read_model(Case, case), Inputs()))
    means = Means(tmp_path / "cache", lambda *_: None)
    figure = _root_stress_figure(RUN.figures(RUN.compute(alone, Inputs(), means)))
    for gear, panel in zip(("pinion", "wheel"), figure.content, strict=True):
        assert max(panel.lines[0].y) == pytest.approx(found[gear]["tension"]["stress_mpa"], rel=1e-9)
        assert min(panel.lines[2].y) == pytest.approx(found[gear]["compression"]["stress_mpa"], rel=1e-9)
        assert panel.references[0].value == found[gear]["tension"]["position"]


def test_refusals(case: Path) -> None:
    for arguments, field in ((["--torque", "-1"], "torque"), (["--torque", "1", "--force", "1"], "force")):
        refused = loa(case, *arguments)
        assert refused.exit_code == 2
        assert field in refused.stderr
        assert refused.stdout == ""
    refused = loa(case, "--image", case.parent / "nowhere" / "root.png")
    assert (refused.exit_code, "output" in refused.stderr) == (2, True)
