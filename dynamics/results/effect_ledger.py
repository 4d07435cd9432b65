"""The effect ledger of a run in plain JSON: decisions, worth, price, and what the run said about them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from dynamics.system.assemble import System
from dynamics.system.observation import static_deflections
from dynamics.types import Json

NOT_CHECKED = "no; switching it over measures it (ablation)"
POSITIONS = 32


def effect_ledger(system: System, checks: Sequence[Json], turned_on: Mapping[str, str]) -> Json:
    """Return entries, what the model leaves out, and the checks.

    Parameters
    ----------
    system : System
    checks : sequence of dict
        What `RunChecks` found.
    turned_on : mapping of str to str
        Automatic effects that are on because a run without them showed that they are needed, and why.
    """
    deflection = mean_deflection(system)
    whole = system.ledger.to_json()
    entries = [_entry(entry, deflection, checks, turned_on) for entry in whole["entries"]]
    return {**whole, "entries": entries, "checks": list(checks)}


def mean_deflection(system: System) -> float:
    """Return the largest of the meshes' mean static transmission errors under the nominal force, m."""
    table = system.arrays.elements.laws.flank.table
    position, touched = np.arange(POSITIONS) / POSITIONS, np.empty(POSITIONS)
    found = [0.0]
    for index, force in enumerate(system.flanks.nominal_force):
        static_deflections(table, index, position, float(force), touched)
        found.append(float(np.mean(np.abs(touched))))
    return max(found)


def _entry(entry: Json, deflection: float, checks: Sequence[Json], turned_on: Mapping[str, str]) -> Json:
    """One effect of one part."""
    own = [one for one in checks if (one["effect"], one["part"]) == (entry["effect"], entry["part"])]
    found = {
        "worth_relative": entry["worth"] / deflection if deflection > 0.0 else None,
        "checked": "; ".join(one["reason"] for one in own) or NOT_CHECKED,
        "holds": all(one["holds"] for one in own) if own else None,
    }
    if entry["effect"] in turned_on and entry["on"]:
        reason = f"on after a run without it: {turned_on[entry['effect']]}"
        found |= {"choice": "auto", "reason": reason, "price": ""}
    return {**entry, **found}
