"""Automatic effects that a requested tolerance does not need."""

from __future__ import annotations

from collections.abc import Sequence

from fe_contact.allowed_error import AllowedError
from fe_contact.effects import ContactScene, LedgerEntry
from fe_contact.effects.influence import EstimatedInfluence, estimate_influences

SHARE = 0.1
"""Part of the tolerance that all neglected effects together may change by their estimates, which are right
within a factor of two in most cases (docs/effects/influence.md): what is neglected stays below it."""


def neglected_effects(
    scene: ContactScene, ledger: Sequence[LedgerEntry], tolerance: AllowedError | None
) -> dict[str, str]:
    """Return the automatic effects whose estimated influence is below the tolerance's share, and why.

    Parameters
    ----------
    scene : ContactScene
    ledger : sequence of LedgerEntry
        As the scene alone decides.
    tolerance : AllowedError or None
        Of mean and peak-to-peak; None: nothing is neglected.

    Returns
    -------
    dict of str to str
        The smallest first, until their sum would exceed the share.
    """
    if tolerance is None:
        return {}
    automatic = [entry.name for entry in ledger if entry.on and entry.choice == "auto"]
    able = [name for name in automatic if scene.effect(name).without(scene) is not None]
    decided = {entry.name: "on" if entry.on else "off" for entry in ledger}
    estimates = estimate_influences(scene, decided, able, tolerance.least_scale)
    neglected: dict[str, str] = {}
    total = 0.0
    influences = [(name, influence) for name, influence in estimates.items() if influence is not None]
    for name, influence in sorted(influences, key=lambda item: item[1].largest):
        total += influence.largest
        if total > SHARE * tolerance.relative:
            break
        neglected[name] = _reason(influence, tolerance)
    return neglected


def _reason(influence: EstimatedInfluence, tolerance: AllowedError) -> str:
    """Say why an effect is neglected: an estimate of another size than the tolerance bounds nothing."""
    part = tolerance.part_words(influence.largest)
    return f"neglected: estimated, within a factor of two in most cases, at {part} where it is largest"
