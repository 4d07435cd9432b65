"""``loa frontier``: page and picture of the ladders of cases and scenes, beyond the contract."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from command_line import loa

from dynamics.accuracy import FidelityResult as SceneResult
from dynamics.accuracy import Frontier as SceneFrontier
from fe_contact import FlankModification, Frontier, GearPair
from fe_contact.analysis.studies.fidelity_result import FidelityResult
from fe_contact.analysis.studies.full_contact_cost import FULL_CONTACT, MEASURED_GEAR, known_full_contact
from fe_contact.analysis.studies.full_contact_record import PLANE, FullContactComparison, FullContactRecord
from lineofaction.gearbox.studies.frontier.run import RUN
from lineofaction.report.drawing.image import png
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.page import html
from lineofaction.report.effects.frontier import PAGE

EXAMPLE = Path(__file__).parents[3] / "examples" / "palermo_spur_20_20.toml"


def ladder(name: str, seconds: float, error: float) -> FidelityResult:
    one = np.ones(1)
    stages = {"contact": seconds}
    return FidelityResult(name, name, seconds, one, one, 0.1, stages, 2**20, error, 2.0 * error)


@pytest.fixture
def found():
    rungs = (ladder("iso6336", 1e-2, 0.3), ladder("corrected", 1.0, 1e-3), ladder("3d_fine", 9.0, 5e-4))
    return Frontier(rungs, {"3d_draft": "no mesh"}, "corrected", "3d_fine", 64)


def test_the_picture_marks_knee_chosen_and_reference(found):
    figure = PAGE.figure(found)
    texts = [note.text for note in figure.content[0].notes]
    assert texts == ["iso6336", "corrected (knee)", "3d fine (chosen, reference)"]
    assert png(figure).startswith(b"\x89PNG")
    layout = plotly_figure(figure)["layout"]
    at = [note for note in layout["annotations"] if note["text"] == "corrected (knee)"]
    assert [(note["x"], note["y"]) for note in at] == [
        (0.0, pytest.approx(-1.0)),
        (0.0, pytest.approx(np.log10(0.2))),
    ]


def test_full_contact_costs_its_known_time_on_the_pair_that_was_measured(found):
    found = dataclasses.replace(found, known_full_contact=FULL_CONTACT)
    peer = next(line for line in PAGE.figure(found).content[0].lines if line.name.startswith("full contact"))
    assert peer.x.tolist() == [12.0 * 64, 30.0 * 64, 75.0 * 64]
    np.testing.assert_allclose(peer.y, [0.06, 0.02, 0.02])
    assert "CalculiX 2.20" in PAGE.figure(found).caption


def test_no_point_of_another_pair_stands_on_a_case(found):
    figure = PAGE.figure(found)
    assert [line.name for line in figure.content[0].lines if "contact" in line.name] == []
    assert "20/20" not in figure.caption and "Peer" not in figure.caption
    assert len(next(PAGE.text(found)).rows) == len(found.results)
    assert RUN.figures(found)["full_finite_element_contact"] == []


def test_full_contact_is_known_of_the_very_pair_alone():
    pair = GearPair(MEASURED_GEAR, MEASURED_GEAR, 80e-3)
    relieved = FlankModification(tip_relief=10e-6, tip_relief_length=1e-3)
    others = (
        dataclasses.replace(pair, wheel=dataclasses.replace(MEASURED_GEAR, teeth=21), center_distance=82e-3),
        dataclasses.replace(pair, pinion=dataclasses.replace(MEASURED_GEAR, modification=relieved)),
        dataclasses.replace(pair, center_distance=80.1e-3),
    )
    assert known_full_contact(pair) == FULL_CONTACT
    assert [known_full_contact(other) for other in others] == [(), (), ()]


def test_full_contact_of_the_case_stands_beside_the_known_cost(found):
    lag = np.array([[[7.8e-6], [np.nan]]])
    record = FullContactRecord(
        pair={},
        version="0.1",
        solved_in=PLANE,
        misalignment=np.zeros(1),
        position=np.array([0.0, 0.5]),
        torque=np.array([100.0]),
        transmission_error=lag,
        error_estimate=1e-3 * lag,
        unknowns=90_000,
        seconds_per_solve=30.0,
    )
    live = FullContactComparison(record, mean_error=0.03, plane_strain_mean=0.002)
    figure = PAGE.figure(dataclasses.replace(found, full_contact=live))
    mean, swing = figure.content
    drawn = {line.name: line for line in mean.lines}["full contact of this pair, recorded"]
    assert (drawn.x.tolist(), drawn.y.tolist()) == ([pytest.approx(30.0 * 64)], [pytest.approx(3.0)])
    assert mean.notes[-1].text == "full contact"
    assert "full contact" not in [note.text for note in swing.notes]  # one position has no peak-to-peak
    assert "2 positions under 1 loads" in figure.caption and "differs from it by 0.20 %" in figure.caption
    assert "differ by at most 0.10 %" in figure.caption
    assert "what plane strain leaves out" in figure.caption
    assert figure.table.rows[-1][-1] == "1 of 2 positions x loads solved"


def test_full_contact_is_for_cases(tmp_path):
    scene = EXAMPLE.with_name("palermo_scene.toml")
    done = loa("frontier", scene, "--full-contact", "2")
    assert done.exit_code == 2
    assert "full_contact = 2: must be left out for a scene" in done.stderr


def test_the_page_says_what_was_not_run(found):
    page = PAGE.page(found)
    text = html(page, {"frontier": b""})
    assert "no mesh" in text
    assert len(next(PAGE.text(found)).rows) == 3


def test_an_error_that_is_not_known_is_left_out(found):
    lonely = ladder("3d_fine", 9.0, float("nan"))
    whole = RUN.figures(Frontier((*found.results[:2], lonely), {}, None, None, 64))
    json.dumps(whole, allow_nan=False)
    assert "mean_error" not in whole["rungs"][2]
    assert whole["rungs"][0]["mean_um"] == [1.0 / 1e-6] and whole["rungs"][0]["mean_error"] == 0.3
    assert set(whole["rungs"][0]) - set(whole["rungs"][2]) == {"mean_error", "peak_to_peak_error"}
    assert whole["reference"] == "3d_fine" and "errors" not in whole["rungs"][0]
    PAGE.figure(Frontier((*found.results[:2], lonely), {}, None, None, 64))


# Of a scene.


@pytest.fixture
def of_scene():
    nothing = float("nan")
    rungs = (
        SceneResult("quasi_static", "quasi-static", 0.01, "model", 0.1, 0.2, 1.0),
        SceneResult("torsion", "torsion only", 0.2, "model", 0.05, 0.05, nothing),
        SceneResult("1_nm", "tolerance 1 nm", 0.5, "steps", 1e-3, 1e-3, 2e-3),
        SceneResult("0.1_nm", "tolerance 0.1 nm", 1.0, "steps", 1e-4, 1e-4, 2e-4),
    )
    return SceneFrontier(rungs, {"in_plane": "nothing more"}, "1_nm", "1_nm", 5, 6, np.ones((1, 1)))


def test_the_picture_of_a_scene_marks_knee_chosen_and_reference(of_scene):
    figure = PAGE.figure(of_scene)
    texts = [note.text for note in figure.content[0].notes]
    assert texts == ["quasi static", "torsion", "1 nm (knee, chosen)", "0.1 nm (reference)"]
    assert [note.text for note in figure.content[2].notes] == [t for t in texts if t != "torsion"]
    assert png(figure).startswith(b"\x89PNG")


def test_the_page_of_a_scene_leaves_unknown_errors_out(of_scene):
    assert "nothing more" in html(PAGE.page(of_scene), {"run_frontier": b""})
    assert next(PAGE.text(of_scene)).rows[1][4] == ""


def test_the_verb_chooses_the_rung_of_a_run_up(tmp_path):
    scene, case = (EXAMPLE.with_name(f"palermo_{name}.toml").read_text() for name in ("scene", "spur_20_20"))
    short = scene.replace("duration_s = 5.0", "duration_s = 0.3").replace("[0.0, 955.0]", "[600.0, 955.0]")
    (tmp_path / "scene.toml").write_text(short)
    (tmp_path / "palermo_spur_20_20.toml").write_text(case.replace("tolerance = 0.01", 'level = "draft"'))
    rungs = "quasi_static,10_nm,1_nm,0.1_nm"
    done = loa("frontier", tmp_path / "scene.toml", "--rungs", rungs, "--json")
    assert done.exit_code == 0, done.output
    printed = json.loads(done.stdout)
    assert (printed["chosen"], printed["reference"]) == ("1_nm", "0.1_nm")
