"""The effect ledger and what was checked, in lines for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from service.convert.units import UM


def ledger_lines(ledger: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the decision about every effect, what it is worth at the largest load, and its price."""
    for entry in ledger:
        state = "on " if entry["on"] else "off"
        yield f"effect {entry['name']}: {state} ({entry['choice']}); {entry['reason']}"
        if entry["decision"].startswith(("left off", "on after")):
            yield f"       {entry['decision']}"
        if entry["on"] or entry["called_for"]:
            yield f"       {worth_words(entry)}; cost {cost_words(entry)}"
        if entry["price"]:
            yield f"       price of the choice: {entry['price']}"


def worth_words(entry: Mapping[str, Any]) -> str:
    """Say what leaving an effect out is estimated to change."""
    found = entry["worth_estimate"]
    if found is None:
        return f"worth: {entry['worth']}"
    mean, ripple = found["mean_m"][-1] / UM, found["peak_to_peak_m"][-1] / UM
    return (
        f"without it mean {mean:+.2g} um ({100 * found['relative_mean']:+.2g} %), "
        f"peak-to-peak {ripple:+.2g} um ({100 * found['relative_peak_to_peak']:+.2g} %)"
    )


def cost_words(entry: Mapping[str, Any]) -> str:
    """Say what an effect costs."""
    seconds = entry["cost_cpu_seconds"]
    return str(entry["cost"]) if seconds is None else f"{seconds:.2g} CPU s ({entry['cost']})"


def assumption_lines(receipt: Mapping[str, Any]) -> Iterator[str]:
    """Yield what was repeated and why, and the assumptions that do not hold."""
    for again in receipt.get("repeated", ()):
        for name, reason in again["turned_on"].items():
            yield f"repeated with {name}: {reason} ({again['cpu_seconds']:.2g} CPU s)"
    for one in receipt.get("assumptions", ()):
        if one["holds"] is False:
            yield f"DOES NOT HOLD: {one['assumption']}; {one['reason']}"


def run_lines(attributes: Mapping[str, Any]) -> Iterator[str]:
    """Yield what a dynamic run was repeated for, and what it took for granted that does not hold."""
    again = attributes.get("receipt", {}).get("repeated")
    if again:
        for name, reason in again["turned_on"].items():
            since = f", from {again['since']:.6g} s on" if again.get("since") else ""
            yield f"repeated with {name}: {reason} (first run {again['seconds']:.2g} s{since})"
    for one in attributes.get("effect_ledger", {}).get("checks", ()):
        if one["holds"] is False:
            part = one["part"] or one["effect"]
            yield f"DOES NOT HOLD: {one['assumption']} ({part}); {one['reason']}"
