"""The effect ledger of a run in lines for people."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def effect_lines(ledger: Mapping[str, Any]) -> list[str]:
    """Return one line per effect that is on, or off though it is worth something: part, worth in um, why.

    `ledger` is that of a run: what it is worth is the static displacement along the line of action, in m.
    """
    entries = [entry for entry in ledger.get("entries", ()) if entry["on"] or entry["worth"] > 0.0]
    return [
        f"effect {entry['effect']}, {entry['part']}: {'on' if entry['on'] else 'off'}, "
        f"worth {1e6 * entry['worth']:.3g} um: {entry['reason']}"
        for entry in entries
    ]
