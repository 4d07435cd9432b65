"""The predicted cost of a job from its inputs alone, by which the progress of a batch is weighted."""

from __future__ import annotations

import json
from typing import Any

from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request_check import check_request
from lineofaction.gearbox.convert.case import analysis_options, boundary_errors, gear_pair, table_axes
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case


def predicted_seconds(inputs: dict[str, Any]) -> float | None:
    """Return the CPU seconds of the table of a case, its studies in proportion; None of what has no case."""
    if inputs.get("case") is None:
        return None
    case = Case.model_validate_json(json.dumps(inputs["case"]))
    try:
        with boundary_errors():
            checked = check_request(gear_pair(case), table_axes(case), analysis_options(case))
            return decide(checked).predicted(None).cpu_seconds
    except BadInput:  # of a wish that no mesh meets: the job will say so
        return None
