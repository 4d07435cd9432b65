"""What the client's models of plans and drawings declare is what the service answers, all of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from lineofaction.gearbox.convert.live import outline_json
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.schemas.plan import OutlineBody, PlanBody
from service.live.work import live_plan

EXAMPLES = Path(__file__).parents[3] / "service" / "page" / "examples"


def through_json(answer: dict[str, Any]) -> Any:
    return json.loads(json.dumps(answer, allow_nan=False))


@pytest.mark.parametrize("name", ["helical_ev_23_67", "industrial_spur_21_59"])
def test_plans_and_drawings_are_as_declared(name: str, tmp_path: Path) -> None:
    case = read_model(Case, EXAMPLES / f"{name}.toml")
    plan = through_json(
        live_plan({"case": case.model_dump(mode="json"), "time_budget_s": None, "cache": str(tmp_path)})
    )
    assert PlanBody.model_validate(plan).model_dump(mode="json", exclude_unset=True) == plan
    drawing = through_json(outline_json(case))
    assert OutlineBody.model_validate(drawing).model_dump(mode="json") == drawing
