"""Every verb ends with its result: main figures with their errors, then the files."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from service.cli.commands import app

SPUR = Path(__file__).parents[3] / "examples" / "palermo_spur_20_20.toml"
COARSE = ("--level", "draft", "--set", "accuracy.positions=16")


def last_lines(*arguments: object, count: int = 3) -> list[str]:
    done = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert done.exit_code == 0, done.output
    return done.stdout.strip().splitlines()[-count:]


def test_a_table_ends_with_mean_and_ripple_and_its_file(tmp_path: Path) -> None:
    file = tmp_path / "ste.nc"
    mean, ripple, written = last_lines("analyze", SPUR, "-o", file, "--torque", 100, *COARSE)
    assert re.fullmatch(r"mean STE at 100 N m: [\d.]+ µm ± [\d.]+ µm", mean)
    assert re.fullmatch(r"peak-to-peak STE at 100 N m: [\d.]+ µm ± [\d.]+ µm", ripple)
    assert written == f"written to {file}"


@pytest.mark.parametrize("verb", ["flank", "root-stress"])
def test_a_study_ends_with_its_headlines_and_its_file(verb: str, tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    *results, written = last_lines(verb, SPUR, "-o", file, *COARSE, count=2)
    assert re.match(r"\S.*: [\d.]+ MPa", results[-1])
    assert written == f"written to {file}"


def test_a_plan_ends_with_what_it_chose() -> None:
    assert "mesh standard" in last_lines("plan", SPUR, count=1)[0]
