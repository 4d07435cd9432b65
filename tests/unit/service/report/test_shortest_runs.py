"""Runs that hold too little for a plot are read all the same: what is missing is said in a sentence."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.table import Table
from typer.testing import CliRunner

from dynamics.errors import InputError
from dynamics.orders import order_waterfall
from dynamics.results import RunResult
from dynamics.results.run_result import SERIES
from fe_contact.ste import SteDatabase
from lineofaction.cli.commands import app
from lineofaction.cli.output import console
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES
from lineofaction.report.comparison.compare import stored_comparison
from lineofaction.report.document import _study_page, stored_figures
from lineofaction.report.run.signals import TOO_SHORT

STORED = "lineofaction.report.document"

SHAPES = {name: series.dimensions for name, series in SERIES.items()}


def first(run: RunResult, samples: int, **changes: Any) -> RunResult:
    cut = {
        name: value[..., :samples]
        for name, value in vars(run).items()
        if isinstance(value, np.ndarray) and value.shape[-1:] == run.time.shape
    }
    return replace(run, **(cut | changes))


@pytest.mark.parametrize("samples", [1, 2, 21, 100, 161])
def test_a_run_of_few_samples_is_drawn(run: RunResult, samples: int, tmp_path: Path) -> None:
    first(run, samples).to_netcdf(tmp_path / "run.nc")
    report = stored_figures({"file": str(tmp_path / "run.nc")})
    assert json.dumps(report, allow_nan=False)
    drawn = [figure["key"] for section in report["sections"] for figure in section["figures"]]
    assert "signal" in drawn
    assert ("spectrum" in drawn) == (TOO_SHORT not in [section["text"] for section in report["sections"]])


@pytest.mark.parametrize("speed", [0.0, 1e-9])
def test_a_run_without_motion_is_drawn(run: RunResult, speed: float, tmp_path: Path) -> None:
    """Nothing varies, and the mesh frequency lies below the first line of the spectrum."""
    still = {"mesh_frequency": np.full_like(run.mesh_frequency, speed), "position": 0.0 * run.position}
    replace(run, bearing_force=0.0 * run.bearing_force, **still).to_netcdf(tmp_path / "run.nc")
    report = stored_figures({"file": str(tmp_path / "run.nc")})
    assert json.dumps(report, allow_nan=False)
    assert "spectrum" in [figure["key"] for section in report["sections"] for figure in section["figures"]]


def test_runs_too_short_for_orders_are_refused_by_their_length(run: RunResult, tmp_path: Path) -> None:
    first(run, 400).to_netcdf(tmp_path / "run.nc")
    with pytest.raises(BadInput, match="at least 16 base pitches"):
        stored_comparison({"files": [str(tmp_path / "run.nc")] * 2})


def test_a_run_without_meshes_is_not_compared(run: RunResult, tmp_path: Path) -> None:
    alone = {name: value[:0] for name, value in vars(run).items() if SHAPES.get(name, ("",))[0] == "mesh"}
    case = run.case | {"meshes": [], "gears": []}
    replace(run, **(alone | {"mesh": (), "case": case})).to_netcdf(tmp_path / "run.nc")
    with pytest.raises(BadInput, match="a run without meshes"):
        stored_comparison({"files": [str(tmp_path / "run.nc")] * 2})


def test_orders_of_a_run_without_meshes_are_refused(run: RunResult, tmp_path: Path) -> None:
    rotor = replace(run, mesh=(), position=run.position[:0], mesh_frequency=run.mesh_frequency[:0])
    with pytest.raises(InputError, match="orders are those of a mesh"):
        order_waterfall(rotor, "bearing_force")


def test_a_defect_of_drawing_is_no_damage_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = STUDIES["response"]

    monkeypatch.setattr(f"{STORED}.read_stored", lambda _study, _file: object())
    monkeypatch.setattr(f"{STORED}.page_beside", _defect)
    with pytest.raises(ValueError, match="argmax of an empty sequence"):
        _study_page(study, tmp_path / "response.nc")


def _defect(*_arguments: object) -> None:
    raise ValueError("argmax of an empty sequence")


def test_a_table_is_no_run_to_export(database: SteDatabase, tmp_path: Path) -> None:
    database.to_netcdf(tmp_path / "ste.nc")
    ended = CliRunner().invoke(app, ["export", str(tmp_path / "ste.nc"), "-o", str(tmp_path / "run.csv")])
    assert (ended.exit_code, ended.stderr[:12]) == (2, "error: file ")
    assert "must be a run" in ended.stderr


@pytest.mark.parametrize("name", ["[/b]", "[red]", ":smile:"])
def test_a_terminal_shows_names_as_they_are(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    grid = Table(name, title=name)
    grid.add_row(name)
    console().print(f"bearing {name}")
    console().print(grid)
    assert capsys.readouterr().out.count(name) == 4
