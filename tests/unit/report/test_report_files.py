"""The report from files, as a page and as JSON: what they are is read from them, what is wrong is said."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5netcdf
import numpy as np
import pytest
from command_line import loa

from dynamics.orders import highest_valid_order, order_frequency
from dynamics.results import RunResult
from fe_contact.analysis.studies.fidelity_result import FidelityResult
from fe_contact.analysis.studies.frontier import Frontier
from lineofaction.gearbox.problems import BadInput, DamagedFile
from lineofaction.gearbox.studies.frontier.run import RUN
from lineofaction.report.comparison.compare import stored_comparison
from lineofaction.report.document import page_json, page_of, read_inputs, stored_figures, write_report
from lineofaction.report.drawing.figure import Panel
from lineofaction.report.effects.frontier import PAGE
from lineofaction.report.run.signals import (
    order_amplitudes,
    signal_over_time,
    signal_spectrum,
    spectrum_window,
)
from lineofaction.report.run.view import RunView, selected_signal

Work = Callable[[dict[str, Any]], Any]


@pytest.fixture
def files(tmp_path, database, run):
    database.to_netcdf(tmp_path / "ste.nc")
    run.to_netcdf(tmp_path / "run.nc")
    return tmp_path / "ste.nc", tmp_path / "run.nc"


STATIC = {
    "pair_drawing",
    "ste",
    "ripple",
    "ste_spectrum",
    "ste_waterfall",
    "load_sharing",
    "mesh_stiffness",
    "deflection_budget",
    "flanks_over_torque",
}
DYNAMIC = {
    "dynamic_error",
    "signal",
    "spectrum",
    "levels",
    "order_map",
    "campbell",
    "octave_bands",
    "dynamic_factor",
}


def test_a_page_and_all_images_of_both(files, tmp_path):
    written = write_report(files, tmp_path / "report.html", tmp_path / "images")
    assert written[0] == tmp_path / "report.html"
    assert {path.stem for path in written[1:]} == STATIC | DYNAMIC
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in written[1:])
    page = written[0].read_text(encoding="utf-8")
    assert "Gear pair 20/20" in page
    assert "mean STE at 100 N m" in page  # the load of the run
    assert sorted(tmp_path.rglob(".*")) == []


@pytest.mark.parametrize(("index", "shown", "missing"), [(0, STATIC, DYNAMIC), (1, DYNAMIC, STATIC)])
def test_one_file_alone(files, tmp_path, index, shown, missing):
    (path,) = write_report(files[index], tmp_path / "report.html")
    page = path.read_text(encoding="utf-8")
    assert all(f'<figure id="{key}">' in page for key in shown)
    assert not any(f'<figure id="{key}">' in page for key in missing)


def test_two_of_a_kind_are_refused(files, tmp_path):
    with pytest.raises(BadInput, match="the only run"):
        write_report([files[1], files[1]], tmp_path / "report.html")


def test_no_file_is_refused(tmp_path):
    with pytest.raises(BadInput, match="at least one file"):
        write_report([], tmp_path / "report.html")


def test_what_is_no_result_is_refused_by_name(tmp_path):
    text, other = tmp_path / "a.nc", tmp_path / "b.nc"
    text.write_text("hello")
    with h5netcdf.File(other, "w") as file:
        file.attrs["format"] = "something else"
    with pytest.raises(BadInput, match="There is no such file"):
        write_report(tmp_path / "none.nc", tmp_path / "report.html")
    with pytest.raises(BadInput, match="not a readable netCDF-4"):
        write_report(text, tmp_path / "report.html")
    with pytest.raises(BadInput, match="another kind"):
        write_report(other, tmp_path / "report.html")
    assert not (tmp_path / "report.html").exists()


def test_a_damaged_file_is_refused(files, tmp_path):
    with h5netcdf.File(files[0], "a") as file:
        file.attrs["data_sha256"] = "0" * 64
    with pytest.raises(BadInput, match="undamaged database"):
        write_report(files[0], tmp_path / "report.html")


def test_an_old_report_survives_a_failed_one(files, tmp_path):
    target = tmp_path / "report.html"
    write_report(files[0], target)
    before = target.read_bytes()
    with pytest.raises(BadInput):
        write_report(tmp_path / "none.nc", target)
    assert target.read_bytes() == before


@pytest.mark.parametrize("work", [stored_figures, stored_comparison])
def test_of_a_stored_file_nobody_learns_where_it_is(tmp_path, work):
    """It is damage in the store, not a fault of the caller."""
    (tmp_path / "a.nc").write_text("hello")
    with pytest.raises(DamagedFile, match="not a readable netCDF-4 file") as refused:
        work({"file": str(tmp_path / "a.nc"), "files": [str(tmp_path / "a.nc")] * 2})
    assert str(tmp_path) not in str(refused.value)


def rung(name: str, error: float, seconds: float) -> FidelityResult:
    ripple = np.array([1e-6, 2e-6])
    return FidelityResult(
        name, name, seconds, 4.0 * ripple, ripple, 0.01, {"contact": seconds}, 2**28, error, 2.0 * error
    )


LADDER = Frontier(
    (rung("iso6336", 0.2, 0.01), rung("plane_strain", 0.04, 0.3), rung("3d_fine", float("nan"), 60.0)),
    {"corrected": "not asked for"},
    "plane_strain",
    "plane_strain",
    128,
)


def test_a_stored_table_has_the_figures_of_its_report(database, tmp_path):
    file = tmp_path / "ste.nc"
    database.to_netcdf(file)
    found = stored_figures({"kind": "database", "file": str(file)})
    page = page_of(read_inputs([file]))
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    drawn = [figure for section in found["sections"] for figure in section["figures"]]
    assert [f["key"] for f in drawn] == [f.key for section in page.sections for f in section.figures]
    assert all(f["alternative"] and f["plot"]["data"] and f["plot"]["layout"] for f in drawn)
    assert [h["value"] for h in found["headlines"]] == [h.value for h in page.headlines]


def test_a_stored_ladder_is_drawn_as_a_fresh_one(tmp_path):
    file = tmp_path / "frontier.nc"
    RUN.file.write(LADDER, file)
    fresh = page_json(PAGE.page(LADDER))
    assert stored_figures({"kind": "frontier", "file": str(file)}) == fresh
    assert RUN.figures(RUN.file.read(file)) == RUN.figures(LADDER)


def test_a_ladder_on_which_nothing_is_off_has_no_points():
    alone = replace(LADDER, results=(rung("3d_fine", float("nan"), 60.0),), knee=None, chosen="3d_fine")
    for panel in PAGE.figure(alone).content:
        assert isinstance(panel, Panel) and panel.lines == () and panel.y.scale == "log"
    ((_, seconds, *_),) = next(PAGE.text(alone)).rows
    assert float(seconds) == 60.0


ROTOR = Path(__file__).parents[3] / "examples" / "jeffcott_scene.toml"
SPEED = 3843.5 / 60.0  # turns per second


@pytest.fixture(scope="module")
def rotor_run(tmp_path_factory):
    file = tmp_path_factory.mktemp("rotor") / "run.nc"
    told = loa("simulate", ROTOR, "-o", file)
    assert told.exit_code == 0, told.output
    return file


def test_the_spectrum_of_a_run_has_order_1(rotor_run, tmp_path):
    result = RunResult.from_netcdf(rotor_run)
    assert order_frequency(result) == pytest.approx(np.full(result.time.size, SPEED))
    assert highest_valid_order(result) == math.floor(1000.0 / 2.56 / SPEED)
    figure = signal_spectrum(result, selected_signal(result, RunView(scale="peak")))
    assert "shaft frequency" in figure.caption
    (line,) = figure.content[0].lines
    history = signal_over_time(result, selected_signal(result, RunView()))
    assert history.content[1].title == "three turns at 3844 rpm"
    window = order_frequency(result)[spectrum_window(result.time)]
    first, second = order_amplitudes(line.x, line.y, window)[:2]
    assert first[1] > 1e3 * second[1]
    written = write_report(rotor_run, tmp_path / "run.html", tmp_path / "images")
    assert {file.stem.partition("_")[0] for file in written} == {"run", "signal", "spectrum", "unit"}
    assert "shaft order" in written[0].read_text("utf-8")


@pytest.mark.parametrize(
    ("verb", "says"),
    [("modes", "71.18 Hz"), ("response", "force on bearing left"), ("steady", "rms bearing force of left")],
)
def test_studies_print_and_draw_bearings(verb, says, tmp_path):
    file = tmp_path / f"{verb}.nc"
    told = loa(verb, ROTOR, "--speed-rpm", "3800,4000", "-o", file)
    assert told.exit_code == 0, told.output
    assert says in told.output
    assert write_report(file, tmp_path / "page.html")[0].exists()
