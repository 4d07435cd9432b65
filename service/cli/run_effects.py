"""The effect ledger of a run in lines for people."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bounds import engineering


def effect_lines(ledger: Mapping[str, Any]) -> list[str]:
    """Return a line per effect that is on, or off though it moves something: part, influence in um, why.

    `ledger` is that of a run: influence is the static displacement along the line of action, in m. Then
    the price of choices, and what leaving an effect out in all its parts is estimated to change.
    """
    entries = [entry for entry in ledger.get("entries", ()) if entry["on"] or entry["worth"] > 0.0]
    lines = [
        f"effect {entry['effect']}, {entry['part']}: {'on' if entry['on'] else 'off'}, "
        f"influence {engineering(1e6 * entry['worth'], 3)} um: {entry['reason']}"
        for entry in entries
    ]
    prices = [
        f"       {entry['effect']}, {entry['part']}: price of the choice: {entry['price']}"
        for entry in entries
        if entry.get("price")
    ]
    influences = [
        f"without {name} about {row['words']} ({row['freedoms']:+d} freedoms, {row['rows']:+d} rows with it)"
        for name, row in ledger.get("worths", {}).items()
    ]
    return [*lines, *prices, *influences]
