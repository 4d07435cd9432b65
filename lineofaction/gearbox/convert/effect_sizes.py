"""The influence of effects as a ledger tells it: which have a line, at which load, in which words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from fe_contact.effects.influence.estimate import TRIFLE
from lineofaction.gearbox.units import UM, boundary_text

Entry = Mapping[str, Any]


def by_size(ledger: Iterable[Entry]) -> tuple[list[Entry], list[Entry]]:
    """Split a ledger into the effects that have a line of their own and the trifles."""
    entries = list(ledger)
    trifles = [entry for entry in entries if (entry.get("influence") or {}).get("trifle")]
    return [entry for entry in entries if entry not in trifles], trifles


def trifles_title(trifles: Sequence[object]) -> str:
    """Say how many effects are folded away, and below which size."""
    effects = "effect" if len(trifles) == 1 else "effects"
    return f"{len(trifles)} {effects} below {100 * TRIFLE:g} %"


def influence_words(entry: Entry) -> str:
    """Say what leaving an effect out is estimated to change; tables of older versions hold no estimate."""
    influence = entry.get("influence")
    return "not estimated" if influence is None else str(influence["words"])


def influence_place(ledger: Iterable[Entry]) -> str:
    """Say at which load and misalignment the influences of a ledger are; empty if it has none."""
    for entry in ledger:
        if influence := entry.get("influence"):
            skew = boundary_text(influence["misalignment_m"] / UM)
            return f"at {boundary_text(influence['torque_n_m'])} N m, misalignment {skew} um"
    return ""
