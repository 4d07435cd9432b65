"""The ledger in lines for people."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, analyze
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.run_plan import plan_run
from fe_contact.options import AnalysisOptions, TableAxes
from lineofaction.gearbox.convert.effects import assumption_lines, ledger_lines, run_lines
from lineofaction.gearbox.units import boundary_ledger

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)


def test_decisions_influence_price_and_what_does_not_hold_are_told() -> None:
    relieved = Gear(
        teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3,
        modification=FlankModification(tip_relief=0.3e-6, tip_relief_length=1e-3),
    )  # fmt: skip
    table = analyze(
        GearPair(relieved, GEAR), torques=[100.0], tolerance=0.05, positions=64,
        effects={"corner_contact": "off"},
    )  # fmt: skip
    lines = "\n".join(ledger_lines(boundary_ledger(table.metadata.effect_ledger)))
    assert "effect tooth_coupling: on  (auto); contact ratio 1.557" in lines
    assert "neglected: estimated" in lines
    assert "without it mean +0.13 um (+2.1 %), peak-to-peak +0.051 um (+1.8 %)" in lines
    told = list(assumption_lines(table.metadata.receipt))
    assert told == [line for line in told if line.startswith("VIOLATED: tip edges stay clear")]
    assert len(told) == 1
    again = {"turned_on": {"misalignment": "neglected effects are negligible: 3 %"}, "cpu_seconds": 0.5}
    (line,) = assumption_lines({"repeated": [again], "assumptions": []})
    assert line == "repeated with misalignment: neglected effects are negligible: 3 % (0.5 CPU s)"


def test_what_a_neglected_effect_takes_of_the_tolerance_is_its_influence() -> None:
    # the floor is what is allowed: of the mean itself the change is a larger part than of what counts
    trace = FlankModification(tip_relief=1e-6, tip_relief_length=1e-3)
    pinion, allowed = replace(GEAR, modification=trace), AllowedError(0.05, 1e-6)
    options = AnalysisOptions(tolerance=allowed)
    entries = plan_run(GearPair(pinion, GEAR, 80e-3), TableAxes(torques=[100.0]), options).to_json()
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


def test_ledgers_leave_in_um_whichever_version_wrote_them() -> None:
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


def test_a_run_says_what_it_was_repeated_for_and_what_does_not_hold() -> None:
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
        "repeated with backlash: mesh: parted (first run 2 s)",
        "VIOLATED: force inside the table (mesh); forces up to 12 N of 10 N",
    ]
    assert list(run_lines({})) == []
