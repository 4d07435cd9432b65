"""The effect ledger of a scene in lines for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from bounds import engineering
from fe_contact.effects.influence.estimate import TRIFLE
from lineofaction.gearbox.convert.effect_lines import run_lines, trifles_title

Json = Mapping[str, Any]
LEAST = 1e-9  # m, of the static displacement of an effect whose influence is not estimated
_RELATIVE = ("relative_mean", "relative_peak_to_peak", "relative_bearing_force")


def model_lines(attributes: Json) -> Iterator[str]:
    """Yield the effects of a run or a study of a scene, what it was repeated for, and what does not hold.

    `attributes` hold `effect_ledger`, those of a run `receipt` too.
    """
    yield from effect_lines(attributes.get("effect_ledger", {}))
    yield from run_lines(attributes)


def effect_lines(ledger: Json) -> Iterator[str]:
    """Yield the decision about every effect, part by part where they differ, its influence and its price.

    `ledger` is that of a run or a study: influence is the static displacement along the line of action, in m;
    that of a run also estimates what leaving the effect out in all its parts changes. Effects that are off
    and change next to nothing share the last line.
    """
    estimates = ledger.get("worths", {})
    trifles = []
    for name, entries in _by_effect(ledger).items():
        if _is_trifle(entries, estimates.get(name)):
            if any(entry.get("possible", True) for entry in entries):
                trifles.append(name)
            continue
        yield from _decisions(name, entries)
        estimate = estimates.get(name)
        if estimate:
            size = f"{estimate['freedoms']:+d} freedoms" if estimate["freedoms"] else "no freedoms"
            yield f"       without it {estimate['words']}; {size} with it"
        for price in dict.fromkeys(entry.get("price") for entry in entries):
            if price and not (estimate and price.endswith(estimate["words"])):
                yield f"       price of the choice: {price}"
    if trifles:
        yield f"{trifles_title(trifles)}: {', '.join(trifles)}"


def _by_effect(ledger: Json) -> dict[str, list[Json]]:
    """Return the entries of every effect, one for each part."""
    effects: dict[str, list[Json]] = {}
    for entry in ledger.get("entries", ()):
        effects.setdefault(entry["effect"], []).append(entry)
    return effects


def _is_trifle(entries: list[Json], estimate: Json | None) -> bool:
    """Whether an effect is off everywhere and changes next to nothing."""
    if any(entry["on"] for entry in entries):
        return False
    if estimate is not None:
        return all(abs(estimate[name]) < TRIFLE for name in _RELATIVE)
    return all(entry["worth"] < LEAST for entry in entries)


def _decisions(name: str, entries: list[Json]) -> Iterator[str]:
    """Yield a line for each decision and reason, with the parts that share it."""
    shared: dict[tuple[bool, str], list[Json]] = {}
    for entry in entries:
        shared.setdefault((entry["on"], entry["reason"]), []).append(entry)
    for (on, reason), same in shared.items():
        parts = ", ".join(entry["part"] for entry in same)
        largest = max(entry["worth"] for entry in same)
        moved = f"; {engineering(1e6 * largest, 3)} um along the line of action" if largest >= LEAST else ""
        yield f"effect {name}: {'on' if on else 'off'} ({parts}); {reason}{moved}"
