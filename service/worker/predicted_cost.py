"""The predicted cost of a job from its inputs alone, by which the progress of a batch is weighted."""

from __future__ import annotations

from typing import Any

from fe_contact.analysis.request.model_choice import decide
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.problems import BadInput
from service.worker.preparations import CASES


def predicted_seconds(inputs: dict[str, Any]) -> float | None:
    """Return the CPU seconds of the table of a case, its studies in proportion; None of what has no case."""
    if inputs.get("case") is None:
        return None
    case = CASES.of_json(inputs["case"])
    try:
        checked = case.checked
        with boundary_errors():
            return decide(checked).predicted(None).cpu_seconds
    except BadInput:  # of a wish that no mesh meets: the job will say so
        return None
