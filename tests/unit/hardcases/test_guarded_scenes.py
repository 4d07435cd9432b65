"""One scene that breaks does not end the suite, nothing passes by having run; which ends are good."""

import json
import multiprocessing

import pytest
import scenes_that_break as fake
from command_line import loa
from random_cases import kind_of_end, random_request

import lineofaction.cli.hardcases as verb
from fe_contact.errors import InputError
from lineofaction.gearbox.problems import EXIT_BAD_INPUT, EXIT_FAILED
from lineofaction.hardcases import HARD_SCENES, Measured, Outcome, run_scenes


@pytest.fixture(autouse=True)
def _imported_once(monkeypatch):
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["lineofaction.hardcases.scene_process", "scenes_that_break"])
    monkeypatch.setattr("lineofaction.hardcases.scene_process.multiprocessing.get_context", lambda _: context)


@pytest.mark.law
def test_crash_hang_and_exception_each_end_one_scene_only():
    scenes = [fake.CRASHING, fake.GOOD, fake.HANGING, fake.RAISING, fake.GOOD]
    crashed, good, hung, raised, last = run_scenes(scenes)
    assert not crashed.passed and "code 7" in crashed.failure
    assert not hung.passed and "limit of 0.2 s" in hung.failure
    assert not raised.passed and raised.failure == "ZeroDivisionError: by nothing"
    assert good.passed and last.passed and good.figures == last.figures


@pytest.mark.parametrize(
    ("scene", "failure"),
    [
        (fake.OUT_OF_BOUNDS, "two 2 (<= 1)"),
        (fake.NO_NUMBER, "nothing nan"),
        (fake.UNBOUNDED, "nothing was measured"),
    ],
)
def test_a_scene_passes_by_its_figures_alone(scene, failure):
    outcome = scene.run()
    assert not outcome.passed
    assert outcome.failure == failure
    json.dumps(outcome.to_json(), allow_nan=False)


def test_what_meets_its_bound_exactly_is_no_margin():
    assert Measured("answers", 1.0, minimum=1.0).use is None
    assert Measured("left", 0.0, maximum=0.0).use is None
    assert Measured("error", 0.5, maximum=2.0).use == 0.25


def test_cpu_time_counts_what_a_scene_starts():
    outcome = fake.STARTING.run()
    assert (
        0.08 <= outcome.cpu_seconds < 60.0
    )  # the child takes 0.1 by its own clock, times are told in ticks of 0.01


def test_the_verb_prints_json_and_fails_with_its_scenes(monkeypatch, tmp_path):
    monkeypatch.setattr(verb, "HARD_SCENES", (fake.GOOD, fake.OUT_OF_BOUNDS, fake.NO_NUMBER))
    page = tmp_path / "page.html"
    result = loa("hardcases", "--json", "-o", page)
    assert result.exit_code == EXIT_FAILED
    first, second, third = json.loads(result.stdout)["scenes"]
    assert first["passed"] and not second["passed"] and not third["passed"]
    assert {"name", "hard_because", "criterion", "passed", "figures", "seconds", "cpu_seconds"} <= set(first)
    assert first["figures"] == {"one": 1.0, "for information": 5.0}
    assert third["figures"] == {"nothing": None}
    assert "out_of_bounds failed: two 2 (&lt;= 1)" in page.read_text()


def test_the_verb_ends_well_with_what_is_chosen(monkeypatch):
    monkeypatch.setattr(verb, "HARD_SCENES", (fake.GOOD, fake.OUT_OF_BOUNDS))
    result = loa("hardcases", "--only", "good")
    assert result.exit_code == 0, result.output
    assert "1 of 1 scenes passed" in result.stdout


def test_unknown_scenes_are_refused():
    result = loa("hardcases", "--only", "no_such_scene")
    assert result.exit_code == EXIT_BAD_INPUT
    assert result.stderr.startswith("error: only = 'no_such_scene': must be a scene or a family")
    assert HARD_SCENES[0].name in result.stderr


REFUSAL = str(InputError("teeth", 3, "at least 4", "Add teeth."))


@pytest.mark.parametrize(
    ("ended_by", "end"),
    [
        (f"InputError: {REFUSAL}", "refusal"),
        ("InfeasibleGeometry: undercut: pinion.tip_diameter = 1.0: must be above 2 m", "refusal"),
        ("InputError: something is wrong", "unclear"),
        (f"InputError: {REFUSAL}\nand more", "unclear"),
        (f"InputError: {REFUSAL}{'!' * 500}", "unclear"),
        ("MeshError: poor", "mesh"),
        ("SolveError: residual", "solve"),
        ("ValueError: teeth are not all condensed", "exception"),
        ("not done after its limit of 600 s", "hang"),
        ("its process ended with code -9", "crash"),
    ],
)
def test_only_a_clear_refusal_is_as_good_as_a_table(ended_by, end):
    assert kind_of_end(Outcome(fake.GOOD, (), 1.0, ended_by)) == end


def test_a_table_must_be_sound():
    assert kind_of_end(fake.GOOD.run()) == "table"
    assert kind_of_end(fake.OUT_OF_BOUNDS.run()) == "unsound"
    assert kind_of_end(fake.NO_NUMBER.run()) == "unsound"


@pytest.mark.parametrize("kind", ["plane", "face"])
def test_a_seed_is_a_case_and_cases_are_both_feasible_and_not(kind):
    ends = []
    for seed in range(60):
        try:
            first, again = random_request(kind, seed), random_request(kind, seed)
            assert first == again
            ends.append(True)
        except InputError:
            ends.append(False)
    assert 15 <= sum(ends) <= 50
