"""Every verb begins with its result, main figures with their errors, and ends with the files."""

import re
from pathlib import Path

import pytest
from command_line import loa
from small_table import small_table

from lineofaction.client import LineOfActionClient

SPUR = Path(__file__).parents[3] / "examples" / "palermo_spur_20_20.toml"
COARSE = ("--level", "draft", "--set", "accuracy.positions=16")


def ends(*arguments: object, first: int = 2) -> tuple[list[str], str]:
    done = loa(*arguments)
    assert done.exit_code == 0, done.output
    lines = done.stdout.strip().splitlines()
    return lines[:first], lines[-1]


def test_a_table_begins_with_mean_and_ripple_and_ends_with_its_file(tmp_path):
    file = tmp_path / "ste.nc"
    (mean, ripple), written = ends("analyze", SPUR, "-o", file, "--torque", 100, *COARSE)
    figure = r"([\d.]+) µm ± [\d.]+ µm"
    # Figures end with the second digit of their errors: ratios of those written are as fine.
    for name, line, excess, digits in (("mean", mean, 1.028, 2e-3), ("peak-to-peak", ripple, 1.033, 4e-3)):
        found = re.fullmatch(rf"{name} STE at 100 N m: {figure}; gears of this width {figure}", line)
        assert found is not None, line
        assert float(found[2]) / float(found[1]) == pytest.approx(excess, abs=digits)
    assert written == f"written to {file}"


def test_a_plan_begins_with_what_it_chose():
    done = loa("plan", SPUR)
    size, chosen, *_ = done.stdout.splitlines()
    assert re.fullmatch(r"standard: [\d.]+ CPU s, [\d.]+ GiB; nothing is computed yet", size)
    assert "mesh standard: as requested" in chosen
    assert [line.split()[:2] for line in done.stdout.splitlines() if ">" in line] == [[">", "standard"]]


def test_a_fetched_result_ends_with_its_figures(tmp_path, monkeypatch):
    stored, file, key = tmp_path / "stored.nc", tmp_path / "fetched.nc", "ab" * 32
    small_table().to_netcdf(stored)
    monkeypatch.setattr(LineOfActionClient, "fetch_result", lambda *_: (stored, "database"))
    results, written = ends("fetch", key, "-o", file, first=3)
    assert results[0] == f"database {key}"
    assert [line.partition(" STE at ")[0] for line in results[1:]] == ["mean", "peak-to-peak"]
    assert written == f"written to {file}"
