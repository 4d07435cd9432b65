"""``loa plan``: the plan of a case as a table and as JSON, and wishes that cannot both be had."""

import json
from pathlib import Path

from command_line import loa

EXAMPLE = Path(__file__).parents[3] / "examples" / "sensitivity_automotive.toml"


def plan(*arguments: str) -> str:
    done = loa("plan", EXAMPLE, *arguments)
    assert done.exit_code == 0, done.output
    return done.stdout


def test_json_holds_cost_error_and_effects() -> None:
    found = json.loads(plan("--json"))
    assert found["choice"]["level"] == "standard"
    assert found["prediction"]["cpu_seconds"] > 0.0
    assert [entry["level"] for entry in found["levels"]] == ["draft", "standard", "fine"]
    assert {entry["name"] for entry in found["effect_ledger"]} > {"corner_contact", "misalignment"}


def test_a_time_that_is_too_short_is_said() -> None:
    assert "cannot be had" in plan("--time-budget-s", "0.001")
    assert "cannot be had" not in plan("--time-budget-s", "1e6")
