"""Plausibility of gear pairs and their results: named checks with limits and sources.

A check warns and changes no number. What cannot be is refused by `InputError`, with an `InputError`.
"""

from __future__ import annotations

from fe_contact.plausibility.check import CHECKS, merged, unexpected
from fe_contact.plausibility.pair_checks import mesh_findings, pair_findings
from fe_contact.plausibility.result_checks import flank_findings, root_findings, table_findings

__all__ = [
    "CHECKS",
    "flank_findings",
    "merged",
    "mesh_findings",
    "pair_findings",
    "root_findings",
    "table_findings",
    "unexpected",
]
