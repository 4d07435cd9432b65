"""The effect ledger of a run or a study with the size of its effects, from which all outputs read them."""

from __future__ import annotations

from collections.abc import Mapping

from dynamics.effects import EffectLedger
from dynamics.influence.neglected_check import Influence
from dynamics.types import Json


def sized_ledger(ledger: Json, automatic: Mapping[str, str], influences: Mapping[str, Influence]) -> Json:
    """Return `EffectLedger.to_json` with the size of every effect, and reasons and prices that follow.

    `automatic` are effects that were left to "auto" and are not as the scene calls for them, and why: for the
    tolerance, or because a run without them showed that they are needed. `influences` are what leaving
    effects out in all their parts is estimated to change.
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
