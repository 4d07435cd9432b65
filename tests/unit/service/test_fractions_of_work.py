"""The fraction reported of work follows the time that its stages take, and of a table its CPU time."""

import ast
import importlib
import itertools
import math
import resource
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.stages import LOADING, PacedFraction
from lineofaction.gearbox.studies.cost import StudyCost, Work
from service.worker.order import WorkOrder
from service.worker.simulation_work import database_of

SHARES = {"analysis": 0.5, "runs": 0.3, "confirmation": 0.2}
Reported = list[tuple[str, float, float]]
"""Stage, share of the time spent, fraction reported."""


def reported(seconds: Mapping[str, float], start_s: float = 3.0, steps: int = 200) -> Reported:
    paced, whole, past, reports = PacedFraction(SHARES.items()), sum(seconds.values()), 0.0, []
    for stage, duration in seconds.items():
        for fraction in np.linspace(0.0, 1.0, steps):
            spent = past + fraction * duration
            done = paced.at(stage, float(fraction), start_s + spent)
            assert done is not None
            reports.append((stage, spent / whole, done))
        past += duration
    return reports


TIMES = [dict(zip(SHARES, seconds, strict=True)) for seconds in itertools.product((0.5, 5.0, 20.0), repeat=3)]


@pytest.mark.parametrize("seconds", TIMES, ids=str)
def test_the_fraction_never_falls_and_ends_at_one(seconds):
    fractions = [fraction for *_, fraction in reported(seconds)]
    assert fractions == sorted(fractions)
    assert fractions[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("seconds", TIMES, ids=str)
def test_the_last_stage_is_right_whatever_the_shares_say(seconds):
    """After a tenth of it; more that was reported before stands until it is true."""
    reports = reported(seconds)
    before = max(fraction for stage, _, fraction in reports if stage != "confirmation")
    last = [(spent, fraction) for stage, spent, fraction in reports if stage == "confirmation"]
    for spent, fraction in last[len(last) // 10 + 1 :]:
        assert fraction == pytest.approx(max(spent, before), abs=0.1)


def test_usual_times_are_reported_as_they_are():
    for _, spent, fraction in reported({"analysis": 5.0, "runs": 3.0, "confirmation": 2.0}):
        assert fraction == pytest.approx(spent, abs=0.01)


@pytest.mark.parametrize("seconds", [{"runs": 6.0, "confirmation": 4.0}, {"confirmation": 9.0}])
def test_stages_that_are_left_out_have_no_share(seconds):
    for _, spent, fraction in reported(seconds):
        assert fraction == pytest.approx(spent, abs=0.01)


PLANNED = (
    Work("gears", 6.0, stage="analysis"),
    Work("runs", 0.5, 40, "runs"),
    Work("repeats", 4.0, stage="runs"),
    Work("program and files", 2.0),
)


def test_shares_of_a_planned_cost_are_those_of_the_time_that_it_takes():
    shares = dict(StudyCost(PLANNED).shares(tuple(SHARES.items()), 2.0))
    assert sum(shares.values()) == pytest.approx(1.0)
    assert shares["analysis"] / shares["runs"] == pytest.approx(6.0 / 24.0)
    assert shares[LOADING] / shares["analysis"] == pytest.approx(2.0 / 6.0)
    assert 0.0 < shares["confirmation"] < 0.03  # the plan does not name it
    unplanned = StudyCost((Work("orders", 3.0),)).shares(tuple(SHARES.items()), 2.0)
    assert unplanned == tuple(SHARES.items())


@pytest.mark.parametrize("slowness", [0.5, 1.0, 3.0])
def test_what_is_left_is_the_plan_scaled_by_what_was_paid_for_the_part_done(slowness):
    """Also where loading is most of the time so far."""
    paced = PacedFraction([(LOADING, 0.2), ("analysis", 0.3), ("runs", 0.5)])
    whole_s = 20.0 * slowness
    paced.at("analysis", 0.0, 0.0)
    for stage, fraction, planned in (("analysis", 0.1, 0.23), ("analysis", 1.0, 0.5), ("runs", 0.5, 0.75)):
        passed_s = planned * whole_s
        done = paced.at(stage, fraction, passed_s)
        assert done is not None
        assert passed_s * (1.0 - done) / done == pytest.approx(whole_s - passed_s, rel=1e-6)


@pytest.mark.parametrize("study", STUDIES.values(), ids=lambda study: study.name)
def test_a_plan_names_only_stages_of_its_study(study):
    """The stages of works are written in the source of the study's package."""
    package = importlib.import_module(f"lineofaction.gearbox.studies.{study.package}")
    folder = Path(str(package.__file__)).parent
    nodes = [node for file in folder.glob("*.py") for node in ast.walk(ast.parse(file.read_text("utf-8")))]
    works = [node for node in nodes if isinstance(node, ast.Call) and ast.unparse(node.func) == "Work"]
    stated = [*(work.args[3] for work in works if len(work.args) > 3)]
    stated += [keyword.value for work in works for keyword in work.keywords if keyword.arg == "stage"]
    named = {node.value for node in stated if isinstance(node, ast.Constant)}
    assert named <= {name for name, _ in study.stages}


def test_an_undeclared_stage_says_nothing():
    paced = PacedFraction(SHARES.items())
    assert paced.at("meanwhile", 0.5, 1.0) is None
    assert paced.at("analysis", 0.5, 1.0) == 0.25


def test_what_a_stage_says_behind_its_name_is_no_other_stage():
    plain, telling = PacedFraction(SHARES.items()), PacedFraction(SHARES.items())
    for fraction, elapsed in ((0.0, 1.0), (0.5, 3.0), (1.0, 5.0)):
        expected = plain.at("analysis", fraction, elapsed)
        assert expected is not None
        assert telling.at("analysis; case: about 25 CPU s, 1.2 GB", fraction, elapsed) == expected


LARGEST_ERROR = 0.15
LARGEST_STEP = 0.2
Report = tuple[float, str, float]
"""CPU seconds since the start, stage, fraction of the whole."""


def helical(face_width_mm: float = 12.0, **accuracy: Any) -> Case:
    width = {"face_width_mm": face_width_mm, "bore_diameter_mm": 12.0}
    pair = {
        "normal_module_mm": 1.8,
        "helix_angle_deg": 22.0,
        "center_distance_mm": 0.9 * 54 / math.cos(math.radians(22.0)),
        "pinion": {"teeth": 23} | width,
        "wheel": {"teeth": 31} | width,
    }
    return validated(Case, {"pair": pair, "load": {"torque_n_m": [50.0, 100.0]}, "accuracy": accuracy})


def cpu_seconds() -> float:
    usages = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def reports_of(case: Case, folder: Path) -> list[Report]:
    """Analyze without a cache; the last report is the end."""
    reports: list[Report] = []
    begun = cpu_seconds()
    order = WorkOrder("", {}, "", folder, folder)
    database_of(
        CheckedCase(case),
        order,
        lambda stage, _, whole=0.0, /: reports.append((cpu_seconds() - begun, stage, whole)),
    )
    return [*reports, (cpu_seconds() - begun, "end", 1.0)]


@pytest.fixture(scope="module")
def reports(tmp_path_factory):
    reports_of(helical(10.0, model="3d", level="draft", positions=8), tmp_path_factory.mktemp("compiles"))
    return reports_of(helical(model="3d", level="draft"), tmp_path_factory.mktemp("measured"))


@pytest.mark.nightly
def test_the_fraction_is_near_the_share_of_the_time_spent(reports):
    whole = reports[-1][0]
    error, stage = max((abs(fraction - spent / whole), stage) for spent, stage, fraction in reports)
    assert error < LARGEST_ERROR, stage


@pytest.mark.nightly
def test_the_fraction_never_falls_and_moves_in_small_steps(reports):
    whole = reports[-1][0]
    assert len({fraction for *_, fraction in reports}) > 50
    for (earlier, _, before), (later, stage, after) in itertools.pairwise(reports):
        assert after >= before, stage
        assert later - earlier < LARGEST_STEP * whole, stage
