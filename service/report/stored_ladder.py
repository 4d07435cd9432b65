"""The accuracy ladder of a case read back from the JSON that it was stored as."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fe_contact.analysis import Frontier
from fe_contact.analysis.rung_result import RungResult

Json = dict[str, Any]


def case_ladder(content: Json) -> Frontier | None:
    """Return the ladder in `content` (`Frontier.to_json`), None if it is that of a scene."""
    rungs = content["rungs"]
    if any("mean_m" not in rung for rung in rungs):
        return None
    names = ("left_out", "solves", "knee", "chosen")
    return Frontier(tuple(_rung(rung) for rung in rungs), **{name: content[name] for name in names})


def _rung(content: Json) -> RungResult:
    """One rung; an error that is not known was left out."""
    names = ("name", "title", "stated_error", "cpu_seconds", "stages", "peak_memory_bytes")
    return RungResult(
        **{name: content[name] for name in names},
        mean=np.array(content["mean_m"], dtype=float),
        peak_to_peak=np.array(content["peak_to_peak_m"], dtype=float),
        mean_error=content.get("mean_error", math.nan),
        peak_to_peak_error=content.get("peak_to_peak_error", math.nan),
    )
