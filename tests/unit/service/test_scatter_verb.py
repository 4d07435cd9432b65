"""``loa scatter``: the same study in tables, files and JSON, whoever does the work."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from spur_case import SPUR
from typer.testing import CliRunner

from lineofaction.cli.commands import app

CASE = (
    SPUR
    + """
[load]
torque_n_m = [100.0, 200.0]
[accuracy]
level = "draft"
model = "plane_strain"
"""
)


@pytest.fixture
def case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    file = tmp_path / "case.toml"
    file.write_text(CASE, encoding="utf-8")
    return file


def test_files_and_terminal_say_the_same(case: Path, tmp_path: Path) -> None:
    asked = ["scatter", str(case), "--samples", "24", "--class", "8"]
    told = json.loads(CliRunner().invoke(app, [*asked, "--json"]).output)
    for ending in ("json", "html", "png"):
        file = tmp_path / f"scatter.{ending}"
        ran = CliRunner().invoke(app, [*asked, "-o", str(file)])
        assert ran.exit_code == 0, ran.output
        assert "Peak to peak of 24 pairs" in " ".join(ran.output.split())
    kept = json.loads((tmp_path / "scatter.json").read_text(encoding="utf-8"))
    assert kept["quantiles"] == told["quantiles"] and kept["peak_to_peak_um"] == told["peak_to_peak_um"]
    assert "rank correlation" in (tmp_path / "scatter.html").read_text(encoding="utf-8")
    assert told["names"] == ["pinion.profile_slope_um", "wheel.profile_slope_um"]
    # class 8: (0.4 m_n + 0.001 d + 4) sqrt(2)^3 = 16.07 um, of which whole ones count
    assert told["asked"]["tolerances"]["pinion.profile_slope_um"] == pytest.approx(16.0, rel=1e-12)
    assert max(max(row) for row in told["deviation_um"]) <= 16.0


def test_workers_beside_a_cluster_are_refused(case: Path) -> None:
    ran = CliRunner().invoke(app, ["scatter", str(case), "--workers", "2", "--dask", "tcp://127.0.0.1:9"])
    assert ran.exit_code != 0 and "left out with --dask" in " ".join(ran.output.split())
