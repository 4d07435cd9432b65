"""What speaks against the geometry of a pair; it can be made and computed all the same."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fe_contact.geometry import Gear, ParallelAxes
from fe_contact.plausibility import mesh_findings

Json = dict[str, Any]


def pair_remarks(pair: ParallelAxes) -> list[Json]:
    """Return the remarks as warnings: `check`, `message`."""
    remarks = (*_undercut(pair), *_backlash(pair))
    findings = [{"check": finding.check, "message": finding.message()} for finding in mesh_findings(pair)]
    return [{"check": check, "message": message} for check, message in remarks] + findings


def _undercut(pair: ParallelAxes) -> Iterator[tuple[str, str]]:
    """Yield the gears whose involute is cut by their tool."""
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        if isinstance(gear, Gear) and gear.form_point.undercut:
            words = "the tool cuts into the involute near the root. Raise its profile shift."
            yield "undercut", f"pair.{name}: {words}"


def _backlash(pair: ParallelAxes) -> Iterator[tuple[str, str]]:
    """Yield whether teeth touch on both flanks."""
    if pair.normal_backlash <= 0.0:
        yield "backlash", "pair: no backlash. Give thickness_allowance_um, or a larger center distance."
