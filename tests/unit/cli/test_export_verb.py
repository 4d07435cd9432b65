"""``loa export``: what it writes and prints, and how it refuses."""

from pathlib import Path

import meshio
import pytest
from command_line import loa, printed
from geared_scenes import gear_pair_scene
from spur_case import spur_case

from dynamics.simulation import simulate

SMALL = spur_case(torques=[50, 100], model="plane_strain")


def test_a_run_becomes_a_universal_file_or_a_table(tmp_path):
    simulate(gear_pair_scene(duration=0.02)).to_netcdf(tmp_path / "run.nc")
    unv = (tmp_path / "run.nc", "-o", tmp_path / "run.unv")
    assert printed("export", *unv, "--function", "spectrum") == {
        "written": [str(tmp_path / "run.unv")],
        "functions": 14,
        "warnings": [],
    }
    assert (tmp_path / "run.unv").read_text().count("\n    58\n") == 14
    assert loa("export", tmp_path / "run.nc", "-o", tmp_path / "run.csv").exit_code == 0
    assert (tmp_path / "run.csv").read_text().startswith("time (s),")
    for arguments in (("run.csv", "--function", "orders"), ("run.unv", "--function", "rms")):
        assert (
            loa("export", tmp_path / "run.nc", "-o", tmp_path / arguments[0], *arguments[1:]).exit_code == 2
        )
    assert loa("export", tmp_path / "run.nc", "-o", tmp_path / "x.unv", "--from", "0.03").exit_code == 2


@pytest.fixture
def small(tmp_path):
    file = tmp_path / "small.toml"
    file.write_text(SMALL)
    return file


def test_one_position_is_two_files_and_several_are_numbered(small, tmp_path):
    assert loa("export", small, "-o", tmp_path / "one").exit_code == 0
    assert sorted(file.name for file in (tmp_path / "one").iterdir()) == ["pinion.vtu", "wheel.vtu"]
    answer = printed("export", small, "--torque", 50, "--at", "0,0.5", "-o", tmp_path / "two")
    names = ["pinion_000.vtu", "wheel_000.vtu", "pinion_001.vtu", "wheel_001.vtu"]
    assert [Path(file).name for file in answer["written"]] == names
    assert [row["position"] for row in answer["positions"]] == [0.0, 0.5]
    assert all(row["residual"] < 1e-10 for row in answer["positions"])
    # one pair at the pitch point, two half a pitch on; half the load bends half as much, but for the contact
    assert answer["positions"][0]["ste_um"] > answer["positions"][1]["ste_um"]
    high, low = (
        meshio.read(tmp_path / name).point_data["von_mises_stress"].max()
        for name in ("one/pinion.vtu", "two/pinion_000.vtu")
    )
    assert high == pytest.approx(2.0 * low, rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--at", "0,x"], "--at = '0,x'"),
        (["--at", ",".join(["0"] * 257)], "at most 256 positions"),
        (["--torque", "5", "--force", "5"], "normal_force_n = 5.0: must be left out"),
    ],
)
def test_bad_arguments_are_one_line_before_the_work(small, tmp_path, arguments, said, monkeypatch):
    monkeypatch.setattr("lineofaction.cli.export.deformed_pairs", None)  # called: code 5
    result = loa("export", small, "-o", tmp_path / "out", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("output", ["small.toml", "out.vtu", "no/such"])
def test_a_folder_that_cannot_be_one_is_refused(small, tmp_path, output):
    result = loa("export", small, "-o", tmp_path / output)
    assert result.exit_code == 2
    assert "output = " in result.stderr
