"""The effect ledger of a table or a run, its influences and its checks, in lines for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sized
from typing import Any

from bounds import engineering
from model_studies.ablation import TRIFLE

Entry = Mapping[str, Any]
Json = Mapping[str, Any]
MIN = 1e-3  # least static displacement of an effect whose influence is not estimated, um
_RELATIVE = ("relative_mean", "relative_peak_to_peak", "relative_bearing_force")


def by_size(ledger: Iterable[Entry]) -> tuple[list[Entry], list[Entry]]:
    """Split a ledger into the effects that have a line of their own and the trifles."""
    entries = list(ledger)
    trifles = [entry for entry in entries if (entry.get("influence") or {}).get("trifle")]
    return [entry for entry in entries if entry not in trifles], trifles


def trifles_title(trifles: Sized) -> str:
    """Return a title with the number of omitted effects and the size below which they are omitted."""
    effects = "effect" if len(trifles) == 1 else "effects"
    return f"{len(trifles)} {effects} below {100 * TRIFLE:g} %"


def influence_text(entry: Entry) -> str:
    """Return the estimated influence of an effect as text; tables of older versions have no estimate."""
    influence = entry.get("influence")
    return "not estimated" if influence is None else str(influence["words"])


def influence_point(ledger: Iterable[Entry]) -> str:
    """Say at which load and misalignment the influences of a ledger are; empty if it has none."""
    for entry in ledger:
        if influence := entry.get("influence"):
            skew, torque = influence["misalignment_um"], influence["torque_n_m"]
            return f"at {torque:.7g} N m, misalignment {skew:.7g} µm"
    return ""


def ledger_table(ledger: Iterable[Entry]) -> tuple[list[str], list[list[str]]]:
    """Return columns and a row for each effect that is no trifle: decision, influence, price, reason."""
    large, _ = by_size(ledger)
    return ["effect", "on", "mean", "p-p", "CPU s", "why"], [_row(entry) for entry in large]


def _row(entry: Entry) -> list[str]:
    influence = entry.get("influence") or {}
    changes = [influence.get(name) for name in ("relative_mean", "relative_peak_to_peak")]
    seconds = entry["cost_cpu_seconds"]
    why = [] if entry["choice"] == "auto" else [f"requested: {entry['choice']}"]
    why.append(entry["reason"])
    if entry["decision"].startswith(("neglected", "on after")):
        why.append(entry["decision"])
    if entry["price"] and entry["on"]:
        why.append(f"price: {entry['price']}")
    return [
        entry["name"].replace("_", " "),
        "yes" if entry["on"] else "no",
        *("" if change is None else f"{engineering(100.0 * change, 2, '+')} %" for change in changes),
        engineering(seconds, 2) if seconds and entry["on"] else "",
        "; ".join(why),
    ]


def assumption_lines(receipt: Mapping[str, Any]) -> Iterator[str]:
    """Yield lines on repeated passes with reasons, and on assumptions that do not hold."""
    for run in receipt.get("repeated", ()):
        for name, reason in run["turned_on"].items():
            yield f"repeated with {name}: {reason} ({engineering(run['cpu_seconds'], 2)} CPU s)"
    for check in receipt.get("assumptions", ()):
        if check["holds"] is False:
            yield f"VIOLATED: {check['assumption']}; {check['reason']}"


def run_lines(attributes: Mapping[str, Any]) -> Iterator[str]:
    """Yield lines on the reasons why a run was repeated, and on its assumptions that do not hold."""
    earlier = attributes.get("receipt", {}).get("repeated")
    if earlier:
        for name, reason in earlier["turned_on"].items():
            since = f", from {earlier['since']:.6g} s on" if earlier.get("since") else ""
            cost = f"{engineering(earlier['seconds'], 2)} CPU s"
            yield f"repeated with {name}: {reason} (first run {cost}{since})"
    corrected = {**attributes, **attributes.get("receipt", {})}.get("base_radius_corrected", {})
    for gear, radius in corrected.items():
        change = f"from {1e3 * radius['given']:.6g} to {1e3 * radius['used']:.6g} mm"
        yield f"base radius of {gear} corrected {change}: one base pitch per train"
    for check in attributes.get("effect_ledger", {}).get("checks", ()):
        if check["holds"] is False:
            part = check["part"] or check["effect"]
            yield f"VIOLATED: {check['assumption']} ({part}); {check['reason']}"
