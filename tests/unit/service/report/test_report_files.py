"""The report from files: what they are is read from them, and what is wrong is said."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5netcdf
import pytest

from dynamics.results import RunResult
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.problems import BadInput, DamagedFile
from lineofaction.report.comparison.compare import stored_comparison
from lineofaction.report.document import read_inputs, stored_figures, write_report

Work = Callable[[dict[str, Any]], Any]


@pytest.fixture
def files(tmp_path: Path, database: SteDatabase, run: RunResult) -> tuple[Path, Path]:
    database.to_netcdf(tmp_path / "ste.nc")
    run.to_netcdf(tmp_path / "run.nc")
    return tmp_path / "ste.nc", tmp_path / "run.nc"


STATIC = {
    "pair_drawing",
    "ste",
    "ripple",
    "ste_spectrum",
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


def test_kinds_are_read_from_the_files(files: tuple[Path, Path]) -> None:
    table, run = (read_inputs([file]) for file in files)
    assert table.run is run.database is None
    assert table.database is not None and run.run is not None


def test_a_page_and_all_images_of_both(files: tuple[Path, Path], tmp_path: Path) -> None:
    written = write_report(files, tmp_path / "report.html", tmp_path / "images")
    assert written[0] == tmp_path / "report.html"
    assert {path.stem for path in written[1:]} == STATIC | DYNAMIC
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in written[1:])
    page = written[0].read_text(encoding="utf-8")
    assert "Gear pair 20/20" in page
    assert "mean STE at 100 N m" in page  # the load of the run
    assert sorted(tmp_path.rglob(".*")) == []


@pytest.mark.parametrize(("index", "shown", "missing"), [(0, STATIC, DYNAMIC), (1, DYNAMIC, STATIC)])
def test_one_file_alone(
    files: tuple[Path, Path], tmp_path: Path, index: int, shown: set[str], missing: set[str]
) -> None:
    (path,) = write_report(files[index], tmp_path / "report.html")
    page = path.read_text(encoding="utf-8")
    assert all(f'<figure id="{key}">' in page for key in shown)
    assert not any(f'<figure id="{key}">' in page for key in missing)


def test_two_of_a_kind_are_refused(files: tuple[Path, Path], tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="the only run"):
        write_report([files[1], files[1]], tmp_path / "report.html")


def test_no_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="at least one file"):
        write_report([], tmp_path / "report.html")


def test_what_is_no_result_is_refused_by_name(tmp_path: Path) -> None:
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


def test_a_damaged_file_is_refused(files: tuple[Path, Path], tmp_path: Path) -> None:
    with h5netcdf.File(files[0], "a") as file:
        file.attrs["data_sha256"] = "0" * 64
    with pytest.raises(BadInput, match="undamaged database"):
        write_report(files[0], tmp_path / "report.html")


def test_an_old_report_survives_a_failed_one(files: tuple[Path, Path], tmp_path: Path) -> None:
    target = tmp_path / "report.html"
    write_report(files[0], target)
    before = target.read_bytes()
    with pytest.raises(BadInput):
        write_report(tmp_path / "none.nc", target)
    assert target.read_bytes() == before


@pytest.mark.parametrize("work", [stored_figures, stored_comparison])
def test_of_a_stored_file_nobody_learns_where_it_is(tmp_path: Path, work: Work) -> None:
    """It is damage in the store, not a fault of the caller."""
    (tmp_path / "a.nc").write_text("hello")
    with pytest.raises(DamagedFile, match="not a readable netCDF-4 file") as refused:
        work({"file": str(tmp_path / "a.nc"), "files": [str(tmp_path / "a.nc")] * 2})
    assert str(tmp_path) not in str(refused.value)
