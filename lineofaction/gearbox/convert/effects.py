"""The effect ledger of a table or a run and what was checked, in lines for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from bounds import engineering
from model_studies.ablation import TRIFLE

# The influence of effects as a ledger tells it: which have a line, at which load, in which words.


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
            skew, torque = influence["misalignment_um"], influence["torque_n_m"]
            return f"at {torque:.7g} N m, misalignment {skew:.7g} um"
    return ""


def ledger_table(ledger: Iterable[Entry]) -> tuple[list[str], list[list[str]]]:
    """Return columns and a row for each effect that is no trifle: decision, influence, price, reason."""
    columns = ["effect", "on", "mean", "p-p", "CPU s", "why"]
    return columns, [_row(entry) for entry in by_size(ledger)[0]]


def _row(entry: Entry) -> list[str]:
    influence = entry.get("influence") or {}
    changes = [influence.get(name) for name in ("relative_mean", "relative_peak_to_peak")]
    seconds = entry["cost_cpu_seconds"]
    why = [
        *([] if entry["choice"] == "auto" else [f"requested: {entry['choice']}"]),
        entry["reason"],
        *([entry["decision"]] if entry["decision"].startswith(("neglected", "on after")) else []),
        *([f"price: {entry['price']}"] if entry["price"] and entry["on"] else []),
    ]
    return [
        entry["name"].replace("_", " "),
        "yes" if entry["on"] else "no",
        *("" if change is None else f"{engineering(100.0 * change, 2, '+')} %" for change in changes),
        engineering(seconds, 2) if seconds and entry["on"] else "",
        "; ".join(why),
    ]


def assumption_lines(receipt: Mapping[str, Any]) -> Iterator[str]:
    """Yield what was repeated and why, and the assumptions that do not hold."""
    for run in receipt.get("repeated", ()):
        for name, reason in run["turned_on"].items():
            yield f"repeated with {name}: {reason} ({engineering(run['cpu_seconds'], 2)} CPU s)"
    for check in receipt.get("assumptions", ()):
        if check["holds"] is False:
            yield f"VIOLATED: {check['assumption']}; {check['reason']}"


def run_lines(attributes: Mapping[str, Any]) -> Iterator[str]:
    """Yield what a dynamic run was repeated for, and what it took for granted that does not hold."""
    earlier = attributes.get("receipt", {}).get("repeated")
    if earlier:
        for name, reason in earlier["turned_on"].items():
            since = f", from {earlier['since']:.6g} s on" if earlier.get("since") else ""
            cost = f"{engineering(earlier['seconds'], 2)} CPU s"
            yield f"repeated with {name}: {reason} (first run {cost}{since})"
    corrected = {**attributes, **attributes.get("receipt", {})}.get("base_radius_corrected", {})
    for gear, radius in corrected.items():
        stated, used = (1e3 * radius[name] for name in ("given", "used"))
        yield f"base radius of {gear} corrected from {stated:.6g} to {used:.6g} mm: one base pitch per train"
    for check in attributes.get("effect_ledger", {}).get("checks", ()):
        if check["holds"] is False:
            part = check["part"] or check["effect"]
            yield f"VIOLATED: {check['assumption']} ({part}); {check['reason']}"


# The effect ledger of a scene in lines for people.

Json = Mapping[str, Any]
LEAST = 1e-3  # um, of the static displacement of an effect whose influence is not estimated
_RELATIVE = ("relative_mean", "relative_peak_to_peak", "relative_bearing_force")


def model_lines(attributes: Json) -> Iterator[str]:
    """Yield the effects of a run or a study of a scene, what it was repeated for, and what does not hold.

    `attributes` hold `effect_ledger`, those of a run `receipt` too.
    """
    yield from _effect_lines(attributes.get("effect_ledger", {}))
    yield from run_lines(attributes)


def effect_size(ledger: Json, effect: str) -> str:
    """Return what a scene loses without an effect in all its parts, in words: the one size that is shown.

    As the ledger of a run or a study estimates it; where it does not, how far flanks move at rest. Empty:
    nothing.
    """
    estimate = ledger.get("influences", {}).get(effect)
    if estimate is not None:
        return str(estimate["words"])
    largest = max(entry["influence_um"] for entry in ledger["entries"] if entry["effect"] == effect)
    return f"{engineering(largest, 3)} um along the line of action at rest" if largest >= LEAST else ""


def _effect_lines(ledger: Json) -> Iterator[str]:
    """Yield the decision about every effect, part by part where they differ, its size and its price.

    `ledger` is that of a run or a study. Effects that are off and change next to nothing share the last line.
    """
    estimates, effects = ledger.get("influences", {}), dict[str, list[Json]]()
    for entry in ledger.get("entries", ()):
        effects.setdefault(entry["effect"], []).append(entry)
    trifles = []
    for name, entries in effects.items():
        size, estimate = effect_size(ledger, name), estimates.get(name)
        if _is_trifle(entries, size, estimate):
            if any(entry.get("possible", True) for entry in entries):
                trifles.append(name)
            continue
        yield from _decisions(name, entries)
        freedoms = ""
        if estimate:
            added = estimate["freedoms"]
            freedoms = f"; {added:+d} freedoms with it" if added else "; no freedoms with it"
        if size:
            yield f"       without it {size}{freedoms}"
        for price in dict.fromkeys(entry.get("price") for entry in entries if entry["on"]):
            if price:
                yield f"       price of the choice: {price}"
    if trifles:
        yield f"{trifles_title(trifles)}: {', '.join(trifles)}"


def _is_trifle(entries: list[Json], size: str, estimate: Json | None) -> bool:
    """Whether an effect is off everywhere and changes next to nothing."""
    if any(entry["on"] for entry in entries):
        return False
    if estimate is not None:
        changes = (*(estimate[name] for name in _RELATIVE), estimate.get("level", {}).get("relative", 0.0))
        return all(abs(change) < TRIFLE for change in changes)
    return not size


def _decisions(name: str, entries: list[Json]) -> Iterator[str]:
    """Yield a line for each decision and reason, with the parts that share it."""
    shared: dict[tuple[bool, str], list[Json]] = {}
    for entry in entries:
        shared.setdefault((entry["on"], entry["reason"]), []).append(entry)
    for (on, reason), same in shared.items():
        parts = ", ".join(entry["part"] for entry in same)
        yield f"effect {name}: {'on' if on else 'off'} ({parts}); {reason}"
