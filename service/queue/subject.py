"""Words for what a job is about."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import Any

from bounds import engineering

Json = dict[str, Any]


@lru_cache(maxsize=1024)
def subject_of(inputs: str) -> str:
    """Return words for normalized inputs, given as JSON: the pair with its highest load, or the scene.

    Empty for inputs that have neither case nor scene.
    """
    facts = json.loads(inputs)
    if facts.get("scene") is not None:
        meshes = len(facts["scene"]["meshes"])
        return f"scene of {meshes} mesh{'' if meshes == 1 else 'es'}"
    return "" if facts.get("case") is None else _pair(facts["case"])


def _pair(case: Json) -> str:
    pair, load = case["pair"], case["load"]
    teeth = "/".join(str(pair[gear]["teeth"]) for gear in ("pinion", "wheel"))
    torques = load.get("torque_n_m") or ()
    up_to = f", up to {engineering(max(torques), 4)} N m" if torques else ""
    return f"{teeth}, module {engineering(pair['normal_module_mm'], 4)} mm{up_to}"
