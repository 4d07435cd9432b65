"""Whether the energy audit of a run closes, and whether every loss in it only grew."""

from __future__ import annotations

from bounds import engineering
from dynamics.results.energy_audit import EnergyAudit
from dynamics.types import Json

UNACCOUNTED = 0.01
"""Of the turnover: more that is not accounted for means that steps miss the motion."""
FALLEN = 1e-3
"""Of the turnover: a loss that falls by more has driven; less is the error of a step's weights."""


def energy_check(audit: EnergyAudit) -> Json:
    """Return the entry of `audit`: what is unaccounted for over the turnover, how far a loss fell in J."""
    lost = audit.fallen > FALLEN * audit.turnover
    missing = audit.relative > UNACCOUNTED
    reason = f"{engineering(100.0 * audit.relative, 2)} % of {audit.turnover:.3g} J is not accounted for"
    if missing:
        reason = f"{reason}: shorten the fixed step, or lower the tolerance of the step control"
    if lost:
        reason = f"{reason}; a loss fell by {audit.fallen:.3g} J, so it supplied energy"
    return {
        "effect": "",
        "assumption": "work is balanced and losses only grow",
        "part": "energy audit",
        "holds": not (lost or missing),
        "valid": not (lost or missing),
        "unaccounted": audit.relative,
        "fallen": audit.fallen,
        "reason": reason,
    }
