"""Checks of a mesh that follow from both gears and their center distance; for the data sheet."""

from __future__ import annotations

from bounds import Finding
from fe_contact.geometry import ParallelAxes
from fe_contact.plausibility.check import assessed


def mesh_findings(pair: ParallelAxes) -> tuple[Finding, ...]:
    """Return what is implausible about the mesh of a pair that can be made and computed all the same."""
    module = pair.pinion.normal_module
    sides = zip(("pinion", "wheel"), pair.tip_clearances, strict=True)
    words = "the tip comes near to the root of the mating gear"
    return tuple(
        finding
        for name, clearance in sides
        for finding in assessed(
            "tip_clearance", f"{name} tip clearance over module", clearance / module, "1", reason=words
        )
    )
