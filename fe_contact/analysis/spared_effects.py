"""Which automatic effects an asked tolerance does not need."""

from __future__ import annotations

from collections.abc import Sequence

from fe_contact.allowed_error import AllowedError
from fe_contact.effects import EFFECTS, ContactScene, LedgerEntry
from fe_contact.effects.sparing import WITHOUT
from fe_contact.effects.worth import Worth, estimate_worths

SHARE = 0.1
"""Part of the tolerance that all spared effects together may be worth by their estimates, which are right
within a factor of two in most cases (docs/effects/influence.md): what is neglected stays below it."""


def spared_effects(
    scene: ContactScene, ledger: Sequence[LedgerEntry], tolerance: AllowedError | None
) -> dict[str, str]:
    """Return the automatic effects whose estimated worth is below the tolerance's share, and why.

    Parameters
    ----------
    scene : ContactScene
    ledger : sequence of LedgerEntry
        As the scene alone decides.
    tolerance : AllowedError or None
        Of mean and peak-to-peak; None: nothing is spared.

    Returns
    -------
    dict of str to str
        The smallest first, until their sum would exceed the share.
    """
    if tolerance is None:
        return {}
    able = [entry.name for entry in ledger if entry.on and entry.choice == "auto" and entry.name in WITHOUT]
    decided = {entry.name: "on" if entry.on else "off" for entry in ledger}
    found = estimate_worths(scene, decided, able, EFFECTS, tolerance.least_scale)
    spared: dict[str, str] = {}
    total = 0.0
    worths = [(name, worth) for name, worth in found.items() if worth is not None]
    for name, worth in sorted(worths, key=lambda one: one[1].largest):
        total += worth.largest
        if total > SHARE * tolerance.relative:
            break
        spared[name] = _reason(worth, tolerance)
    return spared


def _reason(worth: Worth, tolerance: AllowedError) -> str:
    """Say why an effect is left off."""
    change = f"at most {100 * worth.largest:.2g} % of mean or peak-to-peak at any load"
    return f"left off: {change}, and {tolerance.words} are asked for"
