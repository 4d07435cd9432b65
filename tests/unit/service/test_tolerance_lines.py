"""`loa analyze` says early what it knows, and clearly whether the tolerance is met; HTTP jobs as well."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from fe_contact import AllowedError, Gear, GearPair, SteDatabase, analyze
from lineofaction.cli.analyze import _tolerance_lines, _tolerance_warnings
from lineofaction.cli.commands import app
from lineofaction.gearbox.convert.answers import draft_line
from lineofaction.gearbox.problems import EXIT_WARNINGS
from service.worker.simulation_work import DraftedProgress

CASE = """
[pair]
normal_module_mm = 2.0
center_distance_mm = 40.0
[pair.pinion]
teeth = 20
face_width_mm = 12.0
bore_diameter_mm = 20.0
[pair.wheel]
teeth = 20
face_width_mm = 12.0
bore_diameter_mm = 20.0
[load]
torque_n_m = [5.0]
[accuracy]
tolerance = {tolerance}
tolerance_floor_nm = 0
model = "plane_strain"
positions = 32
"""
KEPT = {"relative": 0.01, "floor_m": 2e-8, "used": 1.5, "met": False, "reason": "the limit is 4 passes"}
RAN = {"model": "plane strain", "level": "draft", "slices": 1}
PASS = RAN | {"cpu_seconds": 0.5, "used": 3.0, "refined": []}


@pytest.fixture(scope="module")
def draft() -> SteDatabase:
    pair = GearPair(*[Gear(20, 2e-3, 12e-3, 20e-3)] * 2, 40e-3)
    return analyze(pair, torques=[2.0, 5.0], level="draft", model="plane_strain", positions=16)


def run(tmp_path: Path, tolerance: float, *options: str) -> Result:
    file = tmp_path / "case.toml"
    file.write_text(CASE.format(tolerance=tolerance))
    return CliRunner().invoke(app, ["analyze", str(file), "-o", str(tmp_path / "ste.nc"), *options])


def test_a_tolerance_that_is_met_is_no_warning(tmp_path: Path) -> None:
    done = run(tmp_path, 0.2, "--strict")
    assert done.exit_code == 0, done.output
    assert "tolerance 20 % or 0 nm: met, largest error" in done.stdout
    assert "warning" not in done.output


def test_one_that_is_not_met_is_said_first_with_its_reason_and_decides_the_exit_code(tmp_path: Path) -> None:
    done = run(tmp_path, 0.0001, "--strict")
    assert done.exit_code == EXIT_WARNINGS, done.output
    first = done.stdout.splitlines()[0]
    assert first.startswith("warning (tolerance): tolerance 0.01 % or 0 nm: NOT met, largest error")
    assert first.endswith(")")
    assert re.search(r"\(\w+ would still take .+ of the tolerance: ", first)
    assert (tmp_path / "ste.nc").is_file()
    assert run(tmp_path, 0.0001).exit_code == 0


def test_json_holds_the_warning_and_the_passes(tmp_path: Path) -> None:
    done = json.loads(run(tmp_path, 0.0001, "--json").stdout)
    assert [warning["check"] for warning in done["warnings"]] == ["tolerance"]
    assert done["receipt"]["tolerance"]["met"] is False
    assert done["receipt"]["passes"][-1]["kept"] is True


def test_the_draft_is_one_line_at_the_highest_load(draft: SteDatabase) -> None:
    line = draft_line(draft, "slices 15 -> 23")
    found = re.fullmatch(r"draft: mean (.+) \+- .+ um, p-p (.+) \+- .+ um at 5 N m \(refining (.+)\)", line)
    assert found is not None
    assert float(found[1]) == pytest.approx(1e6 * draft.mean(torque=5.0).value, rel=1e-3)
    assert float(found[2]) == pytest.approx(1e6 * draft.peak_to_peak(torque=5.0).value, rel=1e-3)
    assert found[3] == "slices 15 -> 23"


def test_a_job_carries_the_draft_in_its_stages_and_its_fraction_stays(draft: SteDatabase) -> None:
    told: list[tuple[str, float, float]] = []
    progress = DraftedProgress(lambda *step: told.append(step), refines=True)
    progress.plan({"compliance": 3.0, "contact": 1.0})
    progress("contact", 1.0)
    progress.draft(draft, "mesh draft -> standard")
    progress.plan({"compliance": 6.0, "contact": 2.0})
    progress("compliance", 0.0)
    progress("contact", 0.0)
    assert told[0] == ("contact", 1.0, pytest.approx(0.8))  # a pass may follow
    stage, fraction, whole = told[1]
    assert (stage.split("; ")[0], fraction) == ("compliance", 0.0)
    assert draft_line(draft, "mesh draft -> standard") in stage
    assert whole == told[0][2]  # the whole job does not fall back
    assert told[2][2] == pytest.approx(0.8 + 0.75 * 0.8 * 0.2)


def test_passes_are_listed_where_there_are_several() -> None:
    second = PASS | {"level": "standard", "used": 1.5, "refined": ["mesh draft -> standard"]}
    lines = list(_tolerance_lines({"tolerance": KEPT, "passes": [PASS, second]}))
    assert lines[0] == "tolerance 1 % or 20 nm: NOT met, largest error 1.5 of it"
    assert lines[1] == "pass 1: plane strain, draft, 0.5 CPU s, used 3"
    assert lines[2].endswith("used 1.5, refined mesh draft -> standard")
    assert len(list(_tolerance_lines({"tolerance": KEPT, "passes": [PASS]}))) == 1
    assert list(_tolerance_lines({})) == []


def test_what_is_missed_between_loads_says_where_a_value_is_wanted() -> None:
    beyond = {"axis": "misalignment", "used": 2.0, "between": [0.0, 3e-5]}
    (_, line) = _tolerance_lines({"tolerance": KEPT | {"between_nodes": [beyond]}})
    assert line == "between the misalignments 0 and 30 um interpolation uses 2 of it: add a value there"


def test_errors_that_were_not_estimated_are_no_warning() -> None:
    unknown = {"relative": AllowedError().relative, "floor_m": 2e-8, "used": None, "met": None}
    assert list(_tolerance_warnings({"tolerance": unknown})) == []
    assert [one["check"] for one in _tolerance_warnings({"tolerance": KEPT})] == ["tolerance"]
