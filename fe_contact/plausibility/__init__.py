"""Plausibility of gear pairs and their results: named checks with limits and sources.

A check warns and changes no number. What cannot be is refused elsewhere, with an `InputError`.
"""

from __future__ import annotations

from fe_contact.plausibility.check import CHECKS, Check
from fe_contact.plausibility.finding import (
    Finding,
    PlausibilityWarning,
    finding_of,
    merged,
    unexpected,
    warn_of,
)
from fe_contact.plausibility.pair_checks import pair_findings
from fe_contact.plausibility.result_checks import flank_findings, root_findings, table_findings
from fe_contact.plausibility.units import SI_UNITS, Unit, suspected_unit

__all__ = [
    "CHECKS",
    "SI_UNITS",
    "Check",
    "Finding",
    "PlausibilityWarning",
    "Unit",
    "finding_of",
    "flank_findings",
    "merged",
    "pair_findings",
    "root_findings",
    "suspected_unit",
    "table_findings",
    "unexpected",
    "warn_of",
]
