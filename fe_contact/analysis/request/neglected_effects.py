"""Automatic effects that a requested tolerance does not need."""

from __future__ import annotations

from collections.abc import Sequence

from fe_contact.allowed_error import AllowedError
from fe_contact.effects import ContactScene, LedgerEntry
from fe_contact.effects.influence.estimate import estimate_influences, largest_part

SHARE = 0.1
"""Part of the tolerance that the estimated influences of all neglected effects may add up to. Estimates are
right within a factor of two in most cases (docs/accuracy.md), so that the true influence stays below the
tolerance.
"""

LARGEST_PART = 0.5
"""Part of the tolerance that their gaps together may change at most, by their bounds over estimated sizes."""


def neglected_effects(
    scene: ContactScene, ledger: Sequence[LedgerEntry], tolerance: AllowedError | None
) -> dict[str, str]:
    """Return the automatic effects whose estimated influence is below the tolerance's share, and why.

    The smallest come first, until their sum would exceed the share of mean and peak-to-peak; none without
    a tolerance. An estimate passes single places by: gaps that could change more there stay. The ledger is
    as the scene alone decides.
    """
    if tolerance is None:
        return {}
    automatic = [entry.name for entry in ledger if entry.on and entry.choice == "auto"]
    able = [name for name in automatic if scene.effect(name).without(scene) is not None]
    choices = {entry.name: "on" if entry.on else "off" for entry in ledger}
    estimates = estimate_influences(scene, choices, able, tolerance.least_scale)
    neglected: dict[str, str] = {}
    total, bounded = 0.0, 0.0
    influences = [(name, influence) for name, influence in estimates.items() if influence is not None]
    for name, influence in sorted(influences, key=lambda item: item[1].largest):
        total += influence.largest
        if total > SHARE * tolerance.relative:
            break
        bound = largest_part(
            scene.effect(name).extent(scene), influence.full.mean, influence.full.peak_to_peak, tolerance
        )
        if bounded + bound > LARGEST_PART * tolerance.relative:
            total -= influence.largest
            continue
        bounded += bound
        # an estimate of another size than the tolerance bounds nothing
        estimated = f"within a factor of two in most cases, at {tolerance.part_text(influence.largest)}"
        neglected[name] = f"neglected: estimated, {estimated} where it is largest"
    return neglected
