"""``loa sensitivity``: what it writes and prints, and how it refuses."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import loa
from repository import ROOT

from fe_contact import Sensitivity
from fe_contact.analysis.studies.sensitivity import RippleCurve
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.sensitivity import Inputs
from lineofaction.gearbox.studies.sensitivity.run import RUN, PairStudy, read_studies, write_studies
from lineofaction.report.design.sensitivity import PAGE
from lineofaction.report.document import write_report
from lineofaction.report.drawing.figure import Panel

STUDY = "lineofaction.gearbox.studies.sensitivity.run"

EXAMPLES = sorted((ROOT / "examples").glob("sensitivity_*.toml"))
WIDER = ("--center-distance-change-percent", "0,0.1")  # the teeth do not jam


def means(home: Path) -> Means:
    return Means(home, lambda *_: None)


SMALL = """
[pair]
normal_module_mm = 4.0
center_distance_mm = 80.0
[pair.pinion]
teeth = 20
face_width_mm = 10.0
bore_diameter_mm = 40.0
thickness_allowance_um = 90.0
[pair.wheel]
teeth = 20
face_width_mm = 10.0
bore_diameter_mm = 40.0
[load]
normal_force_n = [500, 1000]
[errors]
misalignment_um = [7]
[accuracy]
level = "draft"
positions = 8
"""


@pytest.fixture
def small(tmp_path):
    file = tmp_path / "small.toml"
    file.write_text(SMALL)
    return file


PAIRS, CLOSER = np.array([1.77, 1.77]), np.array([1.89, 1.77])


def study(name: str = "pair a", factor: float = 1.0) -> PairStudy:
    """A study of round figures."""
    skew = RippleCurve(np.array([0.0, 30e-6]), factor * np.array([2e-6, 5e-6]), np.array([1e-7, 2e-7]), PAIRS)
    distance = RippleCurve(
        np.array([-1e-4, 0.0]), factor * np.array([1e-6, 2e-6]), np.array([3e-7, 4e-7]), CLOSER
    )
    other = RippleCurve(skew.deviation, 0.5 * skew.peak_to_peak, skew.error, PAIRS)
    return PairStudy(
        name, 1000.0, 0.1, (Sensitivity(False, skew, distance), Sensitivity(True, other, distance))
    )


def computed(monkeypatch: pytest.MonkeyPatch, known: PairStudy) -> None:
    monkeypatch.setattr(RUN, "compute", lambda *_: (known,))


def test_a_study_in_a_folder(small, tmp_path):
    """Numbers, table and picture say the same; the highest load counts, the case's own errors do not."""
    result = loa("sensitivity",
        small, "-o", tmp_path / "out", "--misalignment-um", "0,20",
        "--center-distance-change-percent", "-0.05,0.1", "--json",
    )  # fmt: skip
    assert (result.exit_code, result.stderr) == (0, "")
    answer = json.loads(result.stdout)
    written = [Path(file).name for file in answer.pop("written")]
    assert written == [f"sensitivity.{ending}" for ending in ("nc", "json", "png", "html", "csv")]
    (found,) = answer["pairs"]
    assert (found["name"], found["normal_force_n"]) == ("small", 1000.0)
    assert [curves["corner_contact"] for curves in found["curves"]] == [False, True]
    for curves in found["curves"]:
        skew, distance = curves["misalignment"], curves["center_distance"]
        assert skew["misalignment_um"] == pytest.approx([0.0, 20.0])
        assert distance["center_distance_change_percent"] == pytest.approx([-0.05, 0.0, 0.1])
        assert skew["change_percent"][1] == pytest.approx(
            100.0 * (skew["peak_to_peak_um"][1] / skew["peak_to_peak_um"][0] - 1.0)
        )
        assert 0.3 < skew["peak_to_peak_um"][0] < 10.0
    rows = list(csv.reader((tmp_path / "out" / "sensitivity.csv").read_text().splitlines()))
    assert len(rows) == 1 + 2 * (2 + 3)


def test_a_file_by_its_ending_is_the_only_one_written(small, tmp_path, monkeypatch):
    computed(monkeypatch, study())
    result = loa("sensitivity", small, "-o", tmp_path / "x.csv", *WIDER)
    assert result.exit_code == 0
    assert "written to" in result.stdout and "  +150\n" in result.stdout
    assert sorted(file.name for file in tmp_path.iterdir() if file.is_file()) == ["small.toml", "x.csv"]


def test_the_figure_has_a_line_per_pair_and_model_in_four_panels():
    figure = PAGE.figure([study(), study("pair b", 2.0)])
    assert isinstance(figure.content, tuple)
    assert len(figure.content) == 4
    relative, absolute, *_ = figure.content
    assert isinstance(relative, Panel) and isinstance(absolute, Panel)
    assert [line.dash for line in relative.lines] == ["dash", "solid", "dash", "solid"]
    assert relative.lines[0].color == relative.lines[1].color != relative.lines[2].color
    assert relative.lines[0].y == pytest.approx([0.0, 150.0])
    assert absolute.lines[2].y == pytest.approx([4.0, 10.0])
    assert absolute.lines[2].x == pytest.approx([0.0, 30.0])
    assert "pair b without corner contact +150.0 % and -50.0 %" in figure.alternative


def test_a_sentence_says_why_the_center_distance_changes_the_ripple():
    """As the paper has it: closer by 0.2 %, 72 % less with corner contact, 1.77 to 1.89 pairs."""
    sentences = [line for line in PAGE.text([study()]) if isinstance(line, str)]
    assert sentences == [
        "Without and with corner contact: -0.1 % of center distance lowers the ripple by 50 %, since the "
        "contact ratio under load rises from 1.77 to 1.89: one pair alone carries over 11 % of a base pitch "
        "in place of 23 %."
    ]
    several = PAGE.page([study(), study("pair b", 2.0)]).sections[0].text
    assert several.startswith("pair a without and with corner contact: -0.1 % of center distance")
    known = study()
    for pairs, said in (
        (np.array([1.77, 1.77]), "though the contact ratio under load stays at 1.77: the shape of the curve"),
        (np.array([1.60, 1.77]), "though the contact ratio under load falls from 1.77 to 1.60"),
        (np.array([2.10, 1.90]), "one pair alone carries nowhere on a base pitch in place of 10 %"),
        (np.array([2.75, 2.50]), "2 pairs alone carry over 25 % of a base pitch in place of 50 %"),
    ):
        curves = replace(known.curves[1], center_distance_change=replace(
            known.curves[1].center_distance_change, carrying=pairs
        ))  # fmt: skip
        (sentence,) = (
            line for line in PAGE.text([replace(known, curves=(curves,))]) if isinstance(line, str)
        )
        assert said in sentence
    assert PAGE.page([known]).sections[0].text == " ".join(sentences)


def test_the_table_has_every_point():
    rows = PAGE.series([study()]).rows
    assert rows[1] == ("pair a", "off", "misalignment 30 µm", "5.00", "0.20", "+150")
    assert rows[2] == ("pair a", "off", "center distance -0.1 %", "1.00", "0.30", "-50")
    assert len(rows) == 8


def test_several_cases_are_one_study_under_the_names_of_their_files(small, tmp_path, monkeypatch):
    computed(monkeypatch, study())
    other = tmp_path / "sensitivity_wide_face.toml"
    other.write_text(SMALL)
    result = loa("sensitivity", small, other, "-o", tmp_path / "x.nc", "--csv", *WIDER)
    assert result.exit_code == 0
    assert [pair.name for pair in read_studies(tmp_path / "x.nc")] == ["small", "wide face"]
    assert {row[0] for row in csv.reader(result.stdout.splitlines()[1:])} == {"small", "wide face"}


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_the_examples_run_at_every_deviation(file, monkeypatch, tmp_path):
    """Both pairs of the paper's Table 2 exist from -0.2 to +0.2 % of the center distance."""
    assert [file.stem for file in EXAMPLES] == ["sensitivity_automotive", "sensitivity_wind_turbine"]
    studied = []

    def study_nothing(checked, **_):
        studied.append(checked.request)
        return ()

    monkeypatch.setattr(f"{STUDY}.study_sensitivity", study_nothing)
    case = read_model(Case, file)
    varied = Inputs(misalignment_um=(0.0, 60.0), center_distance_change_percent=(-0.2, 0.0, 0.2))
    (found,) = RUN.compute(CheckedCase(case), varied, means(tmp_path))
    assert found.normal_force in (6000.0, 13300.0)
    assert studied[0].center_distance_change[0] == pytest.approx(-0.002 * found.center_distance)


def test_the_highest_torque_is_the_load(small, monkeypatch, tmp_path):
    """20 teeth of module 4 mm: base radius 37.588 mm."""
    monkeypatch.setattr(f"{STUDY}.study_sensitivity", lambda *_, **__: ())
    small.write_text(SMALL.replace("normal_force_n = [500, 1000]", "torque_n_m = [10, 100]"))
    varied = Inputs(center_distance_change_percent=(0.0, 0.1))  # the teeth do not jam
    (found,) = RUN.compute(CheckedCase(read_model(Case, small)), varied, means(tmp_path))
    assert found.normal_force == pytest.approx(100.0 / 37.5877e-3, rel=1e-5)


ALLOWANCE = "thickness_allowance_um = 90.0"


@pytest.mark.parametrize(
    ("allowance", "ends"),
    [("", (0.0, 0.2)), (ALLOWANCE, (-0.1, 0.1)), ("thickness_allowance_um = 200.0", (-0.2, 0.2))],
)
def test_by_default_the_center_distance_stays_where_the_teeth_do_not_jam(allowance, ends, small):
    """Five changes, as far as the backlash lets them; what is named is kept and refused."""
    small.write_text(SMALL.replace(ALLOWANCE, allowance))
    case = RUN.narrowed(CheckedCase(read_model(Case, small)), Inputs())
    RUN.check(case, Inputs())
    own = RUN.normalized(case, Inputs())["center_distance_change_percent"]
    assert (own[0], own[-1], len(own)) == (*ends, 5)
    named = Inputs(center_distance_change_percent=(-5.0, 0.0))
    with pytest.raises(BadInput, match="jam"):
        RUN.check(case, named)


def test_by_default_a_ring_gear_comes_closer():
    case = RUN.narrowed(CheckedCase(read_model(Case, ROOT / "examples" / "internal_gear.toml")), Inputs())
    RUN.check(case, Inputs())
    assert max(RUN.normalized(case, Inputs())["center_distance_change_percent"]) == 0.0


def test_studies_come_back_from_their_file(tmp_path):
    wide = study("pair b", 2.0)
    curves = tuple(
        replace(one, center_distance_change=replace(change, deviation=1.5 * change.deviation))
        for one in wide.curves
        for change in [one.center_distance_change]
    )
    written = (study(), replace(wide, curves=curves, center_distance=0.15))
    write_studies(written, tmp_path / "s.nc")
    back = read_studies(tmp_path / "s.nc")
    assert PAGE.series(back) == PAGE.series(written)
    for one, other in zip(written, back, strict=True):
        assert (one.name, one.normal_force, one.center_distance) == (
            other.name,
            other.normal_force,
            other.center_distance,
        )
        for mine, theirs in zip(one.curves, other.curves, strict=True):
            assert mine.corner_contact is theirs.corner_contact
            assert np.array_equal(mine.misalignment.error, theirs.misalignment.error)
            assert np.array_equal(
                mine.center_distance_change.deviation, theirs.center_distance_change.deviation
            )


def test_a_study_is_on_the_report_page(tmp_path):
    write_studies((study(),), tmp_path / "s.nc")
    page = write_report(tmp_path / "s.nc", tmp_path / "s.html")[0].read_text(encoding="utf-8")
    assert '<figure id="sensitivity">' in page
    assert "<h1>Sensitivity of gear pairs</h1>" in page
    with pytest.raises(BadInput, match="the only sensitivity"):
        write_report([tmp_path / "s.nc", tmp_path / "s.nc"], tmp_path / "t.html")


def test_its_headlines_are_the_largest_ripples():
    skew, distance = PAGE.page((study(), study("pair b", 2.0))).headlines
    assert (skew.name, skew.value) == ("largest peak-to-peak STE over misalignment", "10.00 µm")
    assert skew.remark == "± 0.20 µm at 30 µm, 1000 N, pair b: +150.0 % of the undeviated pair's"
    assert (distance.value, distance.remark[:15]) == ("4.00 µm", "± 0.40 µm at 0 ")
