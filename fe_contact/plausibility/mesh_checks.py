"""Checks of a mesh that follow from both gears and their center distance; for the data sheet."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan, cos, tan

from bounds import Finding
from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.toothing import Toothing
from fe_contact.plausibility.check import assessed


def mesh_findings(pair: ParallelAxes) -> tuple[Finding, ...]:
    """Return what is implausible about the mesh of a pair that can be made and computed all the same."""
    return tuple(_findings(pair))


def _findings(pair: ParallelAxes) -> Iterator[Finding]:
    """Yield the findings on each gear, then those on the mesh."""
    module = pair.pinion.normal_module
    for name, gear, clearance in zip(
        ("pinion", "wheel"), (pair.pinion, pair.wheel), pair.tip_clearances, strict=True
    ):
        field, words = (
            f"{name} tip clearance over module",
            "the tip comes near the root of the mating gear",
        )
        yield from assessed("tip_clearance", field, clearance / module, "1", reason=words)
        field, words = f"{name} tip thickness over module", "the tooth is nearly pointed"
        yield from assessed("tip_thickness", field, _tip_thickness(gear) / module, "1", reason=words)
    words = "the teeth hardly take over from each other"
    ratio = pair.active_contact_ratio
    yield from assessed("contact_ratio", "transverse contact ratio", ratio, "1", reason=words)


def _tip_thickness(gear: Toothing) -> float:
    """Return the normal tooth thickness at the tip circle, m."""
    helix = atan(tan(gear.helix_angle) * gear.tip_radius / gear.reference_radius)
    return gear.tip_tooth_thickness * cos(helix)
