"""The effect ledger of a run or a study with the influences of its effects; all outputs read this ledger."""

from __future__ import annotations

from collections.abc import Mapping

from dynamics.effects import EffectLedger
from dynamics.influence.neglected_check import Influence
from dynamics.types import Json


def sized_ledger(ledger: Json, automatic: Mapping[str, str], influences: Mapping[str, Influence]) -> Json:
    """Return `EffectLedger.to_json` with the size of every effect, and reasons and prices that follow.

    `automatic` gives, by name, why an effect left to "auto" is decided otherwise than the scene calls for:
    the tolerance allows its neglect, or a run without it showed that it is needed. `influences` are the
    estimated changes by leaving an effect out in all its parts.
    """
    entries = [_sized(entry, automatic, influences) for entry in ledger["entries"]]
    sizes = {name: influence.to_json() for name, influence in influences.items()}
    return {**ledger, "entries": entries, "influences": sizes}


def _sized(entry: Json, automatic: Mapping[str, str], influences: Mapping[str, Influence]) -> Json:
    name, sized = entry["effect"], dict(entry)
    if entry["price"] and not entry["on"] and name in influences:
        sized["price"] = f"left out: {influences[name].text}"
    if name in automatic and entry["possible"]:
        sized |= {"choice": "auto", "reason": automatic[name], "price": ""}
    return sized


def neglected_effects(ledger: EffectLedger, influences: Mapping[str, Influence]) -> Json:
    """Return the entry of a receipt on effects that are off: the change of the level by each, the largest.

    Nothing where none of them was estimated.
    """
    on = {entry.effect for entry in ledger.entries if entry.on}
    levels = {name: influence.level for name, influence in influences.items() if name not in on}
    if not levels:
        return {}
    largest = max(levels.values(), key=lambda level: abs(level.decibels))
    return {
        "decibels": largest.decibels,
        "unit": largest.unit,
        "source": f"largest change of {largest.quantity} by one effect that is off",
        "effects": {name: level.decibels for name, level in levels.items()},
    }
