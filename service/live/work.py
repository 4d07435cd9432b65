"""The work of the live worker, never of the service's process: curves of other flanks, and plans."""

from __future__ import annotations

import json
from collections import OrderedDict
from pathlib import Path
from typing import Any

from host import cpu_seconds
from lineofaction.gearbox.convert.case_plausibility import case_warnings
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.live import CondensedCase, condensed_of, live_curves
from lineofaction.gearbox.convert.plan import plan_json, plan_of
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.live import LiveInput

Json = dict[str, Any]

MAX_PAIRS = 4

_cases: OrderedDict[str, CondensedCase] = OrderedDict()


def live_ste(inputs: Json) -> Json:
    """Return the curves of a question; the compliances requested last stay in memory."""
    begin = cpu_seconds()
    question = LiveInput.model_validate_json(json.dumps(inputs["question"]))
    paths = Path(inputs["file"]), Path(inputs["cache"])
    condensed = _condensed_case(inputs["key"], *paths, compute=question.condense)
    read = cpu_seconds() - begin  # to read or compute the compliance, and to check the question
    answer = live_curves(condensed, question)
    answer["cost"]["compliance_cpu_seconds"] += read
    return answer | {"cpu_seconds": cpu_seconds() - begin}


def live_plan(inputs: Json) -> Json:
    """Return the plan of a case as `loa plan --json` prints it."""
    case = CheckedCase(Case.model_validate_json(json.dumps(inputs["case"])))
    cache = Path(inputs["cache"])
    plan = plan_of(case, inputs["time_budget_s"], cache)
    answer = plan_json(plan) | {"warnings": case_warnings(case)}
    name = inputs.get("study")
    return answer if name is None else answer | {"study": _study_cost(name, case, cache)}


def _study_cost(name: str, case: CheckedCase, cache: Path) -> Json | None:
    """Return the predicted cost of a study of a case with its usual inputs; None: it is not predicted."""
    study = STUDIES.get(name)
    if study is None or "case" not in study.takes.subject:
        known = [other for other, row in STUDIES.items() if "case" in row.takes.subject]
        raise BadInput.of("study", name, f"one of {', '.join(known)}")
    cost = study.run.predicted(case, study.inputs(), cache)
    if cost is None:
        return None
    return {"cpu_seconds": cost.seconds, "memory_bytes": cost.bytes, "words": cost.text}


def _condensed_case(key: str, file: Path, cache: Path, *, compute: bool) -> CondensedCase:
    if key not in _cases:
        _cases[key] = condensed_of(file, cache, compute=compute)
    _cases.move_to_end(key)
    while len(_cases) > MAX_PAIRS:
        _cases.popitem(last=False)
    return _cases[key]
