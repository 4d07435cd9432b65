"""``loa export`` of an FMU: what it writes and prints, and how it refuses."""

import re
import zipfile

import pytest
from command_line import loa, printed
from small_table import BASE_RADIUS, small_table


@pytest.fixture
def database(tmp_path):
    file = tmp_path / "ste.nc"
    small_table().to_netcdf(file)
    return file


def test_it_holds_the_whole_table_and_says_so(database, tmp_path):
    options = ("--torque", 100, "--damping-n-s-per-m", 1500)
    answer = printed("export", database, "-o", tmp_path / "m.fmu", *options)
    table = small_table().force_table()
    assert (answer["positions"], answer["levels"]) == (table.position.size, table.level.size)
    assert answer["damping_reach_n"] == pytest.approx(0.05 * 100.0 / BASE_RADIUS)
    with zipfile.ZipFile(answer["file"]) as archive:
        assert 'start="1500.0"' in archive.read("modelDescription.xml").decode()
    again = loa("export", database, "-o", tmp_path / "m.fmu")
    assert again.exit_code == 0
    assert "1 misalignments x 1 center distances" in again.stdout


def test_backlash_gives_it_a_coast_flank(database, tmp_path):
    assert loa("export", database, "-o", tmp_path / "m.fmu", "--backlash-um", 80).exit_code == 0
    with zipfile.ZipFile(tmp_path / "m.fmu") as archive:
        text = archive.read("modelDescription.xml").decode()
    for name, start in (("backlash", f'"{80 * 1e-6!r}"'), ("coast_flank", '"true"')):
        (line,) = re.findall(rf'name="{name}".*?</ScalarVariable>', text, re.DOTALL)
        assert f"start={start}" in line


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--misalignment-um", 10], "left out for an FMU"),
        (["--damping-n-s-per-m", -1], "--damping-n-s-per-m = -1.0: must be 0 or above"),
        (["--torque", 0], "--torque = 0.0: must be above 0"),
        (["--backlash-um", 0], "--backlash-um = 0.0: must be above 0"),
        (["--torque", 1, "--force", 1], "not both"),
    ],
)
def test_arguments_it_cannot_use(database, tmp_path, arguments, text):
    result = loa("export", database, "-o", tmp_path / "m.fmu", *arguments)
    assert result.exit_code == 2
    assert text in result.stderr
    assert not (tmp_path / "m.fmu").exists()


def test_no_database_and_no_compiler(database, tmp_path, monkeypatch):
    assert "an STE database" in loa("export", tmp_path / "no.nc", "-o", tmp_path / "m.fmu").stderr
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    result = loa("export", database, "-o", tmp_path / "m.fmu")
    assert result.exit_code == 2
    assert "a C compiler on the path" in result.stderr
