"""``loa flank`` and ``loa report --flank``: what they write and print, and how they refuse."""

import json

import pytest
from command_line import loa, printed
from spur_case import spur_case

from fe_contact import LoadDistribution
from lineofaction.client import JobState, LineOfActionClient
from lineofaction.gearbox.convert.case import case_at
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.flank_point import FlankPoint

SMALL = spur_case(torques=[50, 100, 200], model="plane_strain", positions=16)


@pytest.fixture
def small(tmp_path):
    file = tmp_path / "small.toml"
    file.write_text(SMALL)
    return file


def test_the_highest_load_of_the_case_is_the_default(small, tmp_path):
    answer = printed("flank", small, "-o", tmp_path / "f.nc")
    found = LoadDistribution.from_netcdf(tmp_path / "f.nc")
    assert answer["torque_n_m"] == pytest.approx(200.0) == found.scene.torque
    assert (answer["positions"], answer["slices"]) == (64, 1)
    assert found.metadata.case["load"] == {"torque_n_m": [200.0], "normal_force_n": None}


def test_the_report_takes_its_own_load_and_both_ways_agree(small, tmp_path):
    assert loa("analyze", small, "-o", tmp_path / "ste.nc").exit_code == 0
    plain = loa("report", tmp_path / "ste.nc", "-o", tmp_path / "plain.html")
    assert plain.exit_code == 0
    assert "contact_pattern" not in (tmp_path / "plain.html").read_text(encoding="utf-8")
    result = loa("report", tmp_path / "ste.nc", "--flank", "-o", tmp_path / "r.html")
    assert result.exit_code == 0
    assert "CPU s" in result.stdout
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "mean STE at 100 N m" in page and "largest flank pressure at 100 N m" in page
    assert "Contact pattern, 20/20, 100 N m" in page and "64 positions of the mesh cycle" in page
    assert loa("flank", small, "--torque", 100, "-o", tmp_path / "f.nc").exit_code == 0
    both = loa("report", tmp_path / "ste.nc", tmp_path / "f.nc", "-o", tmp_path / "b.html")
    assert both.exit_code == 0
    pressure = LoadDistribution.from_netcdf(tmp_path / "f.nc").clear_pressure.max()
    assert f"{1e-6 * pressure:.1f} MPa" in page


def test_a_report_cannot_compute_flanks_of_nothing(small, tmp_path):
    assert loa("flank", small, "-o", tmp_path / "f.nc").exit_code == 0
    result = loa("report", tmp_path / "f.nc", "--flank", "-o", tmp_path / "r.html")
    assert result.exit_code == 2
    assert "Name one or the other" in result.stderr


def test_a_table_made_in_python_says_how_to_go_on(tmp_path):
    from small_table import small_table  # noqa: PLC0415

    small_table().to_netcdf(tmp_path / "ste.nc")
    result = loa("report", tmp_path / "ste.nc", "--flank", "-o", tmp_path / "r.html")
    assert result.exit_code == 2
    assert "to_netcdf" in result.stderr


def case(**changes: object) -> Case:
    gear = {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0}
    pair = {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": gear, "wheel": gear}
    return validated(Case, {"pair": pair, "load": {"normal_force_n": [10.0, 20.0]}} | changes)


def test_what_a_point_leaves_open_is_the_cases():
    errors = {"misalignment_um": [-30.0, 10.0, 60.0], "center_distance_change_mm": [0.05]}
    here = case_at(case(errors=errors), FlankPoint())
    assert here.load.normal_force_n == (20.0,)
    assert here.errors.misalignment_um == (10.0,)
    assert here.errors.center_distance_change_mm == (0.05,)
    other = case_at(case(errors=errors), FlankPoint(torque_n_m=7.0, misalignment_um=-5.0))
    assert (other.load.torque_n_m, other.load.normal_force_n) == ((7.0,), None)
    assert other.errors.misalignment_um == (-5.0,)


def test_equal_questions_are_one_case():
    """Other loads and positions of the table do not matter, so results are shared."""
    one = case_at(case(), FlankPoint())
    other = case(load={"normal_force_n": [5.0, 20.0]}, accuracy={"tolerance": 0.01, "positions": 32})
    assert case_at(other, FlankPoint()) == one


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--process", "nonsense"], "--process = 'nonsense': must be one of analyze, flank, sensitivity"),
        (["--inputs", "{}"], "--inputs = '{}': must be given with --process"),
        (["--process", "flank", "--inputs", "[1]"], "--inputs = '[1]': must be a JSON object without case"),
        (["--process", "flank", "--inputs", '{"a":' * 400 + "1" + "}" * 400], "must be a JSON object"),
        (["--process", "flank", "--inputs", '{"case": {}}'], "must be a JSON object without case"),
    ],
)
def test_a_submission_that_cannot_be_is_one_line(small, arguments, said):
    result = loa("submit", small, *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_a_submission_names_its_process_and_inputs(small, monkeypatch):
    asked: list[tuple[str, dict[str, object]]] = []

    def submit(_client, process, inputs):
        asked.append((process, inputs))
        return JobState("1", process, "accepted", "", "", 0, 0)

    monkeypatch.setattr(LineOfActionClient, "submit", submit)
    options = ["--process", "flank", "--inputs", '{"torque_n_m": 70.0}', "--json"]
    result = loa("submit", small, *options)
    assert json.loads(result.stdout)["process"] == "flank"
    ((process, inputs),) = asked
    assert (process, inputs["torque_n_m"]) == ("flank", 70.0)
    assert validated(Case, inputs["case"]).load.torque_n_m == (50.0, 100.0, 200.0)


def test_the_largest_pressure_is_that_of_the_flank_and_an_edge_is_named_apart(small):
    told = loa("flank", small, "--set", "effects.corner_contact=on")
    answer = printed("flank", small, "--set", "effects.corner_contact=on")
    flank, edge = answer["largest_pressure_mpa"], answer["edge_pressure_mpa"]
    assert min(edge, flank) > 0.0
    (line,) = (line for line in told.stdout.splitlines() if line.startswith("largest flank pressure"))
    assert f"{flank:.4g}"[:3] in line and line.index("MPa") < line.index("at the edges")
