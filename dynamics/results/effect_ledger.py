"""The effect ledger of a run in plain JSON: decisions, influence, price, and the checks of the run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.motion.observation import static_deflections
from dynamics.types import Json

NOT_CHECKED = "no; toggling it measures it (ablation)"
POSITIONS = 32


def effect_ledger(
    system: System,
    checks: Sequence[Json],
    automatic: Mapping[str, str],
    influences: Mapping[str, Json],
) -> Json:
    """Return entries, estimates, what the model leaves out, and the checks.

    Parameters
    ----------
    system : System
    checks : sequence of dict
        What `RunChecks` found.
    automatic : mapping of str to str
        Effects that were left to "auto" and are not as the scene calls for them, and why: for the tolerance,
        or because a run without them showed that they are needed.
    influences : mapping of str to dict
        What leaving effects out in all their parts is estimated to change, with `words`.
    """
    deflection = _mean_deflection(system)
    whole = system.ledger.to_json()
    entries = [_entry(entry, deflection, checks, automatic, influences) for entry in whole["entries"]]
    return {**whole, "entries": entries, "worths": dict(influences), "checks": list(checks)}


def _mean_deflection(system: System) -> float:
    """Return the largest of the meshes' mean static transmission errors under the nominal force, m."""
    table = system.arrays.elements.laws.flank.table
    position, touched = np.arange(POSITIONS) / POSITIONS, np.empty(POSITIONS)
    deflections = [0.0]
    for index, force in enumerate(system.flanks.nominal_force):
        static_deflections(table, index, position, float(force), touched)
        deflections.append(float(np.mean(np.abs(touched))))
    return max(deflections)


def _entry(
    entry: Json,
    deflection: float,
    checks: Sequence[Json],
    automatic: Mapping[str, str],
    influences: Mapping[str, Json],
) -> Json:
    """One effect of one part."""
    name = entry["effect"]
    own = [check for check in checks if (check["effect"], check["part"]) == (entry["effect"], entry["part"])]
    assessed = {
        "worth_relative": entry["worth"] / deflection if deflection > 0.0 else None,
        "checked": "; ".join(check["reason"] for check in own) or NOT_CHECKED,
        "holds": all(check["holds"] for check in own) if own else None,
    }
    if entry["price"] and not entry["on"] and name in influences:
        assessed["price"] = f"left out: {influences[name]['words']}"
    if name in automatic and entry["possible"]:
        assessed |= {"choice": "auto", "reason": automatic[name], "price": ""}
    return {**entry, **assessed}
