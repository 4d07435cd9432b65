"""Every verb ends with its result: main figures with their errors, then the files."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from command_line import loa
from small_table import small_table

from lineofaction.client import LineOfActionClient

SPUR = Path(__file__).parents[3] / "examples" / "palermo_spur_20_20.toml"
COARSE = ("--level", "draft", "--set", "accuracy.positions=16")


def last_lines(*arguments: object, count: int = 3) -> list[str]:
    done = loa(*arguments)
    assert done.exit_code == 0, done.output
    return done.stdout.strip().splitlines()[-count:]


def test_a_table_ends_with_mean_and_ripple_and_its_file(tmp_path: Path) -> None:
    file = tmp_path / "ste.nc"
    mean, ripple, written = last_lines("analyze", SPUR, "-o", file, "--torque", 100, *COARSE)
    end = r" STE at 100 N m: [\d.]+ µm ± [\d.]+ µm; gears of this width "
    assert re.fullmatch(rf"mean{end}\+2\.8 %", mean)
    assert re.fullmatch(rf"peak-to-peak{end}\+3\.3 %", ripple)
    assert written == f"written to {file}"


def test_a_plan_ends_with_what_it_chose() -> None:
    assert "mesh standard" in last_lines("plan", SPUR, count=1)[0]


NUMBER = r"-?[\d.]+"


def test_a_curve_ends_with_its_harmonics_mean_and_ripple(tmp_path: Path) -> None:
    file = tmp_path / "ste.nc"
    small_table().to_netcdf(file)
    harmonics, mean, ripple = last_lines("ste", file, "--torque", 100)
    assert harmonics.startswith("harmonics ")
    assert re.fullmatch(rf"mean STE at 100 N m: {NUMBER} µm .+", mean)
    assert re.fullmatch(rf"peak-to-peak STE at 100 N m: {NUMBER} µm .+", ripple)


def test_a_fetched_result_ends_with_its_figures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stored, file, key = tmp_path / "stored.nc", tmp_path / "fetched.nc", "ab" * 32
    small_table().to_netcdf(stored)
    monkeypatch.setattr(LineOfActionClient, "fetch_result", lambda *_: (stored, "database"))
    *results, written = last_lines("fetch", key, "-o", file, count=4)
    assert results[0] == f"database {key}"
    assert [line.partition(" STE at ")[0] for line in results[1:]] == ["mean", "peak-to-peak"]
    assert written == f"written to {file}"
