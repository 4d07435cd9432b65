"""A ring gear from its case file to table, curve and report."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fe_contact.ste import SteDatabase
from lineofaction.cli.commands import app

EXAMPLE = Path(__file__).parents[2] / "examples" / "internal_gear.toml"


def loa(*arguments: object) -> str:
    """Run the command line in this process."""
    done = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert done.exit_code == 0, done.output
    return done.stdout


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("ring") / "ring.nc"
    loa("analyze", EXAMPLE, "-o", file)
    return file


def test_the_example_becomes_a_table(table: Path) -> None:
    found = SteDatabase.from_netcdf(table)
    assert found.facts.internal
    assert not found.status.any()
    assert found.mean(torque=60.0).value == pytest.approx(3.54e-6, rel=5e-3)
    assert found.load_share.sum(axis=-1) == pytest.approx(1.0, abs=1e-12)


def test_its_curve_and_its_report_can_be_read(table: Path, tmp_path: Path) -> None:
    curve = json.loads(loa("ste", table, "--torque", 60, "--json"))
    assert curve
    page = tmp_path / "ring.html"
    loa("report", table, "-o", page)
    assert "Gear pair 36/96, internal" in page.read_text(encoding="utf-8")
