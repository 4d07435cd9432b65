"""``loa sweep``: names as in the case file or short, the same numbers in every form, three lines."""

import re

import numpy as np
import pytest
from command_line import loa, printed
from spur_case import spur_case

from bounds.error_digits import to_error
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.studies.sweep.run import SWEEPABLE, axis_of_text

CASE = spur_case(
    "tip_relief_um = 15.0\ntip_relief_length_mm = 1.5", torques=[100.0, 200.0], model="plane_strain"
)
OVER = "torque=100:200:50,pinion.tip_relief=0:20:10"


@pytest.fixture
def file(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(CASE, encoding="utf-8")
    return file


@pytest.fixture
def case(file):
    return CheckedCase(read_model(Case, InputFile(file)))


def output(*arguments: object) -> str:
    done = loa(*arguments)
    assert done.exit_code == 0, done.output
    return done.stdout


@pytest.mark.parametrize("name", SWEEPABLE)
def test_every_spelling_means_one_thing(name, case):
    for spelling in SWEEPABLE[name].spellings:
        assert axis_of_text(case, f"{spelling}=1:3:1").name == name


def test_a_name_without_a_gear_means_both_and_its_unit_may_be_left_out(case):
    axis = axis_of_text(case, "tip_relief_um=0:40:20")
    assert axis.values == pytest.approx((0.0, 20e-6, 40e-6))
    assert axis.variables == ("pinion.tip_relief", "wheel.tip_relief")
    assert axis_of_text(case, "pair.pinion.tip_relief_um=0:40:20").variables == ("pinion.tip_relief",)


def test_ranges_that_are_not_given_are_about_the_case(case):
    usual = {
        name: axis_of_text(case, name).values for name in ("torque", "pinion.tip_relief", "misalignment")
    }
    assert usual["torque"][0] == pytest.approx(40.0) and usual["torque"][-1] == 200.0
    assert (usual["pinion.tip_relief"][0], usual["pinion.tip_relief"][-1]) == pytest.approx((0.0, 30e-6))
    np.testing.assert_allclose(usual["misalignment"], -np.array(usual["misalignment"])[::-1])
    length = axis_of_text(case, "pinion.tip_relief_length").values
    assert 0.0 < length[0] < 1.5e-3 < length[-1]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("tip_releif", "tip_relief"),
        ("face_width", "other bodies"),
        ("torque=3,2", "increasing"),
        ("torque=300:100:50", "rises"),
    ],
)
def test_what_is_no_axis_is_refused(case, text, said):
    with pytest.raises(BadInput, match=said):
        axis_of_text(case, text)


def test_files_and_terminal_say_the_same(file, tmp_path):
    target = tmp_path / "map.csv"
    ended = output("sweep", file, "--over", OVER, "-o", target).strip().splitlines()
    best, largest, *_, written = ended
    assert re.match(
        r"least mean peak-to-peak STE over the torques: [\d.]+ µm ± [\d.]+ µm at tip relief", best
    )
    assert re.match(r"largest peak-to-peak STE: [\d.]+ µm ± [\d.]+ µm at torque", largest)
    assert written == f"written to {target}"
    told = printed("sweep", file, "--over", OVER)
    assert len(told["points"]) == 9
    for name, value in (entry for point in told["points"] for entry in point.items()):
        assert name.endswith(("n_m", "tip_relief_um")) or "_error" in name or value > 0.0
    largest_point = max(told["points"], key=lambda point: point["peak_to_peak_um"])
    errors = largest_point["peak_to_peak_um"], largest_point["peak_to_peak_error_um"]
    assert largest.startswith(f"largest peak-to-peak STE: {to_error(*errors)} µm")


def test_what_is_said_to_be_as_low_is(file):
    told = printed("sweep", file, "--over", OVER)
    points = told["points"]
    minimum = min(points, key=lambda point: point["harmonic_1_um"])
    alike = [
        point
        for point in points
        if point["harmonic_1_um"] - minimum["harmonic_1_um"]
        <= point["harmonic_1_error_um"] + minimum["harmonic_1_error_um"]
    ]
    said = told["least"]["harmonic_1_um"]
    assert said["points_within_error"] == len(alike)
    assert said["load.torque_n_m"] == minimum["load.torque_n_m"]


def test_a_report_shows_a_stored_map(file, tmp_path):
    stored, page = tmp_path / "map.nc", tmp_path / "map.html"
    output("sweep", file, "--over", OVER, "-o", stored)
    output("report", stored, "-o", page)
    text = page.read_text(encoding="utf-8")
    assert "tip relief of the pinion" in text and "Peak-to-peak STE over torque on the driving gear" in text
    curve = tmp_path / "curve.png"
    output("sweep", file, "--over", "torque=100:200:50", "--show", "max_pressure", "-o", curve)
    assert curve.stat().st_size > 10_000


def test_the_complaint_of_the_case_is_marked_in_the_plots_and_in_those_of_its_file(file, tmp_path):
    file.write_text(f"{CASE}\n[complaint]\nfrequency_hz = 1000.0\nspeed_rpm = 3000.0\ntorque_n_m = 130.0\n")
    for ending in (".html", ".nc"):
        done = loa("sweep", file, "--over", "torque=100:200:50", "-o", tmp_path / f"map{ending}")
        assert done.exit_code == 0, done.output
    assert loa("report", tmp_path / "map.nc", "-o", tmp_path / "report.html").exit_code == 0
    for page in ("map.html", "report.html"):
        assert "complaint, 130 N m" in (tmp_path / page).read_text("utf-8").replace("\\u00a0", " ")
