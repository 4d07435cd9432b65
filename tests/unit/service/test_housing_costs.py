"""Results of every study of a scene in a housing say what the housing cost and was predicted to."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from declared_figures import check_declared
from housing_solid import write_housed_scene
from typer.testing import CliRunner

from dynamics.work_cost import WorkCost
from lineofaction.cli.commands import app
from lineofaction.report.drawing.tables import amount, cost_tables

STUDIES: dict[str, tuple[str, ...]] = {
    "modes": (),
    "response": ("--speed-rpm", "1500:3000:750", "--orders", "2"),
    "steady": ("--speed-rpm", "1500", "--no-branch"),
    "noise": ("--speed-rpm", "1500:3000:750", "--orders", "2", "--no-band"),
}
COST = vars(WorkCost(24.6, 1.07e9, 25.1, None))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the scene of a block with two bores, and the cache."""
    return write_housed_scene(tmp_path_factory.mktemp("costs"), modes=6)


@pytest.mark.parametrize("study", list(STUDIES))
def test_figures_and_report_state_the_cost_of_the_reduction(
    folder: Path, study: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same from the cache: what was measured once."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
    report = folder / f"{study}.html"
    costs = []
    for more in (("--json",), ("--json", "-o", str(report))):
        result = CliRunner().invoke(app, [study, str(folder / "scene.json"), *STUDIES[study], *more])
        assert result.exit_code == 0, result.stderr
        answer: dict[str, Any] = json.loads(result.stdout)
        check_declared(study, answer)
        costs.append(answer["reduction_cost"]["case"])
    assert costs[0] == costs[1]
    for name in ("predicted_cpu_seconds", "predicted_bytes", "cpu_seconds"):
        assert costs[0][name] > 0.0
    assert "case: reduction" in report.read_text("utf-8")


def test_the_table_has_prediction_beside_measurement() -> None:
    facts = {"seconds": {"response": 0.5, "sound": 0.25}, "reduction_cost": {"case": COST}}
    (table,) = cost_tables(facts)
    assert table.rows == (("case: reduction", "25", "25", "-", "1.1"),)
    radiation = {"case": {"model_name": "monopoles", "cost": COST | {"seconds": 61.5, "bytes": 2e8}}}
    (table,) = cost_tables(facts | {"radiation": radiation})
    assert table.rows[1] == ("case: monopoles, all frequencies", "62", "25", "0.20", "1.1")
    assert cost_tables({"seconds": {}}) == ()


def test_less_than_a_thousandth_is_not_written_out() -> None:
    assert (amount(1.2e-7), amount(None), amount(0.0123)) == ("< 0.001", "-", "0.012")
