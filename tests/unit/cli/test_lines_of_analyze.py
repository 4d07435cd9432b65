"""Lines for people: the ledger of effects, what is known early, and whether the tolerance is met."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import loa
from typer.testing import Result

from bounds.error_digits import with_error
from fe_contact import AllowedError, AnalysisOptions, FlankModification, Gear, GearPair, TableAxes, analyze
from fe_contact.analysis.run_plan import plan_run
from lineofaction.cli.tolerance_lines import tolerance_lines, tolerance_warnings
from lineofaction.gearbox.convert.answers import draft_line
from lineofaction.gearbox.convert.effects import assumption_lines, ledger_table, run_lines
from lineofaction.gearbox.problems import EXIT_WARNINGS
from lineofaction.gearbox.units import boundary_ledger
from service.worker.simulation_work import DraftedProgress

SPUR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)


def test_decisions_influence_price_and_what_does_not_hold_are_told():
    relieved = Gear(
        teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3,
        modification=FlankModification(tip_relief=0.05e-6, tip_relief_length=2e-3),
    )  # fmt: skip
    table = analyze(
        GearPair(relieved, SPUR), torques=[100.0], tolerance=0.05, positions=64,
        effects={"corner_contact": "off"},
    )  # fmt: skip
    columns, rows = ledger_table(boundary_ledger(table.metadata.effect_ledger))
    told = {row[0]: dict(zip(columns, row, strict=True)) for row in rows}
    assert told["tooth coupling"]["on"] == "yes"
    assert told["tooth coupling"]["why"].startswith("contact ratio 1.557")
    assert "neglected: estimated" in told["profile modification"]["why"]
    corner = told["corner contact"]
    assert (corner["on"], corner["mean"], corner["p-p"]) == ("no", "+2.1 %", "+1.8 %")
    assert corner["why"].startswith("requested: off; ")
    (violated,) = assumption_lines(table.metadata.receipt)
    assert violated.startswith("VIOLATED: tip edges stay clear")
    again = {"turned_on": {"misalignment": "neglected effects are negligible: 3 %"}, "cpu_seconds": 0.5}
    (line,) = assumption_lines({"repeated": [again], "assumptions": []})
    assert line == "repeated with misalignment: neglected effects are negligible: 3 % (0.5 CPU s)"


def test_what_a_neglected_effect_takes_of_the_tolerance_is_its_influence():
    # the floor is what is allowed: of the mean itself the change is a larger part than of what counts
    trace = FlankModification(tip_relief=0.4e-6, tip_relief_length=1e-3)
    pinion, allowed = replace(SPUR, modification=trace), AllowedError(0.05, 1e-6)
    options = AnalysisOptions(tolerance=allowed)
    entries = plan_run(GearPair(pinion, SPUR, 80e-3), TableAxes(torques=[100.0]), options).to_json()
    (entry,) = (e for e in entries["effect_ledger"] if e["name"] == "profile_modification")
    influence = entry["influence"]
    parts = [
        abs(influence[f"{name}_m"]) / allowed.of(np.array(influence[f"whole_{name}_m"]))
        for name in ("mean", "peak_to_peak")
    ]
    stated = re.search(r"neglected: .* ([0-9.]+) % of the tolerance \(5 % or 1e\+03 nm\)", entry["decision"])
    assert stated is not None, entry["decision"]
    assert float(stated[1]) == pytest.approx(100.0 * max(parts), rel=0.06)  # two digits
    assert abs(influence["relative_mean"]) > 2.0 * max(parts) * allowed.relative


def test_ledgers_leave_in_um_whichever_version_wrote_them():
    estimate = {"mean_m": [1e-6], "orders_m": [[2e-6]], "bearing_force_n": [3.0], "words": "w"}
    decision = {"effect": "tilt", "part": "input", "on": True}
    former = {
        "entries": [decision | {"worth": 2e-6, "worth_relative": None}],
        "worths": {"tilt": estimate},
        "left_out": {"windage": "small"},
    }
    today = {
        "entries": [decision | {"influence_m": 2e-6, "relative_influence": None}],
        "influences": {"tilt": estimate},
        "left_out": {"windage": "small"},
    }
    left = boundary_ledger(today)
    assert left == boundary_ledger(former)
    assert left["entries"] == [decision | {"influence_um": 2.0, "relative_influence": None}]
    (estimated,) = left["influences"].values()
    assert estimated == {"mean_um": [1.0], "orders_um": [[2.0]], "bearing_force_n": [3.0], "words": "w"}
    load = {"torque_n_m": 1e-6, "misalignment_m": 1e-6}
    (entry,) = boundary_ledger([{"name": "misalignment", "influence": load}])
    assert entry["influence"] == {"torque_n_m": 1e-6, "misalignment_um": 1.0}


def test_a_run_says_what_it_was_repeated_for_and_what_does_not_hold():
    check = {"assumption": "force inside the table", "part": "mesh", "reason": "forces up to 12 N of 10 N"}
    told = list(
        run_lines(
            {
                "receipt": {"repeated": {"turned_on": {"backlash": "mesh: parted"}, "seconds": 2.0}},
                "effect_ledger": {"checks": [check | {"holds": False}, check | {"holds": True}]},
            }
        )
    )
    assert told == [
        "repeated with backlash: mesh: parted (first run 2 CPU s)",
        "VIOLATED: force inside the table (mesh); forces up to 12 N of 10 N",
    ]
    assert list(run_lines({})) == []


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
KEPT = {
    "relative": 0.01,
    "floor_m": 2e-8,
    "used": 1.5,
    "met": False,
    "lasting": 0.003,
    "reason": "the limit is 4",
}
RAN = {"model": "plane strain", "level": "draft", "slices": 1}
PASS = RAN | {"cpu_seconds": 0.5, "used": 3.0, "refined": []}


@pytest.fixture(scope="module")
def draft():
    pair = GearPair(*[Gear(20, 2e-3, 12e-3, 20e-3)] * 2, 40e-3)
    return analyze(pair, torques=[2.0, 5.0], level="draft", model="plane_strain", positions=16)


def run(tmp_path: Path, tolerance: float, *options: str) -> Result:
    file = tmp_path / "case.toml"
    file.write_text(CASE.format(tolerance=tolerance))
    return loa("analyze", file, "-o", tmp_path / "ste.nc", *options)


def test_a_tolerance_that_is_met_is_no_warning(tmp_path):
    done = run(tmp_path, 0.2, "--strict")
    assert done.exit_code == 0, done.output
    assert "tolerance 20 % or 0 nm: met; numerical error " in done.stdout
    assert "warning" not in done.output


def test_a_bias_is_stated_beside_the_errors_and_not_in_them(tmp_path):
    printed = run(tmp_path, 0.2).stdout
    served = json.loads(run(tmp_path, 0.2, "--json").stdout)
    bias, (load,) = served["receipt"]["bias"], served["loads"]
    assert bias["words"] in printed
    found = re.search(r" 5 +\S+ +(\S+) ± (\S+) +(\S+) ± (\S+)", printed)
    assert found is not None, printed
    mean, error, ripple, ripple_error = map(float, found.groups())
    assert (
        abs(mean - load["mean_um"]) < 0.06 * error
        and abs(ripple - load["peak_to_peak_um"]) < 0.06 * ripple_error
    )
    assert (error, ripple_error) == pytest.approx(
        (load["mean_error_um"], load["peak_to_peak_error_um"]), rel=0.06
    )
    assert load["mean_over_face_um"] == pytest.approx((1.0 + bias["mean"]) * load["mean_um"], rel=1e-9)
    assert bias["mean"] * mean > 2.0 * load["mean_over_face_error_um"] > 2.0 * load["mean_error_um"]
    over_face = with_error(load["mean_over_face_um"], load["mean_over_face_error_um"])
    assert f"over the face at 5 N m: mean {over_face} µm" in printed
    sources = printed[printed.index("Errors by source at 5 N m") :].partition("\n\n")[0]
    rows = sources.splitlines()
    assert {"discretization", "method"} <= {row.split()[0] for row in rows[1:]}
    assert not any(row.strip().startswith("finite width") for row in rows)


def test_one_that_is_not_met_is_said_first_with_its_reason_and_decides_the_exit_code(tmp_path):
    done = run(tmp_path, 0.0001, "--strict")
    assert done.exit_code == EXIT_WARNINGS, done.output
    first = done.stdout.splitlines()[0]
    assert first.startswith("warning (tolerance): tolerance 0.01 % or 0 nm: NOT met; numerical error ")
    assert first.endswith(")")
    assert re.search(r"\(\w+ would still take .+ of the tolerance: ", first)
    assert (tmp_path / "ste.nc").is_file()
    assert run(tmp_path, 0.0001).exit_code == 0


def test_json_holds_the_warning_and_the_passes(tmp_path):
    done = json.loads(run(tmp_path, 0.0001, "--json").stdout)
    assert [warning["check"] for warning in done["warnings"]] == ["tolerance"]
    assert done["receipt"]["tolerance"]["met"] is False
    assert done["receipt"]["passes"][-1]["kept"] is True


def test_the_draft_is_one_line_at_the_highest_load(draft):
    line = draft_line(draft, "slices 15 -> 23")
    found = re.fullmatch(r"draft: mean (.+) ± .+ µm, p-p (.+) ± .+ µm at 5 N m \(refining (.+)\)", line)
    assert float(found[1]) == pytest.approx(1e6 * draft.mean(torque=5.0).value, rel=1e-3)
    assert float(found[2]) == pytest.approx(1e6 * draft.peak_to_peak(torque=5.0).value, rel=1e-3)
    assert found[3] == "slices 15 -> 23"


def test_a_job_carries_the_draft_in_its_stages_and_its_fraction_stays(draft):
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


def test_passes_are_listed_where_there_are_several():
    second = PASS | {"level": "standard", "used": 1.5, "refined": ["mesh draft -> standard"]}
    lines = list(tolerance_lines({"tolerance": KEPT, "passes": [PASS, second]}))
    errors = "numerical error 1.5 %; of the method 0.3 %, which no mesh lowers"
    assert lines[0] == f"tolerance 1 % or 20 nm: NOT met; {errors}"
    assert lines[1] == "pass 1: plane strain, draft, 0.5 CPU s, used 3"
    assert lines[2].endswith("used 1.5, refined mesh draft -> standard")
    assert len(list(tolerance_lines({"tolerance": KEPT, "passes": [PASS]}))) == 1
    assert list(tolerance_lines({})) == []


def test_what_is_missed_between_loads_says_where_a_value_is_wanted():
    limit = {"limit": "add a value there"}
    beyond = {"axis": "misalignment", "used": 2.0, "between": [0.0, 3e-5]} | limit
    (_, line) = tolerance_lines({"tolerance": KEPT | {"between_nodes": [beyond]}})
    what = "interpolation errs by 2 times the tolerance: add a value there"
    assert line == f"between the misalignments 0 and 30 µm {what}"
    beyond = {"axis": "force", "used": 2.0, "between": [400.0, 1200.0]} | limit
    (_, line) = tolerance_lines({"tolerance": KEPT | {"between_nodes": [beyond]}}, 40.0)
    assert line == f"between the torques 10 and 30 N m {what}"


def test_errors_that_were_not_estimated_are_no_warning():
    unknown = {"relative": AllowedError().relative, "floor_m": 2e-8, "used": None, "met": None}
    assert list(tolerance_warnings({"tolerance": unknown})) == []
    assert [one["check"] for one in tolerance_warnings({"tolerance": KEPT})] == ["tolerance"]
