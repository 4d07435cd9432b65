"""The effect ledger of a table or a run and what was checked, in lines for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sized
from typing import Any, NamedTuple

from bounds import engineering
from model_studies.ablation import TRIFLE

# The influence of effects as a ledger tells it: which have a line, at which load, in which words.


Entry = Mapping[str, Any]
Json = Mapping[str, Any]
LEAST = 1e-3  # um, of the static displacement of an effect whose influence is not estimated
_RELATIVE = ("relative_mean", "relative_peak_to_peak", "relative_bearing_force")


def by_size(ledger: Iterable[Entry]) -> tuple[list[Entry], list[Entry]]:
    """Split a ledger into the effects that have a line of their own and the trifles."""
    entries = list(ledger)
    trifles = [entry for entry in entries if (entry.get("influence") or {}).get("trifle")]
    return [entry for entry in entries if entry not in trifles], trifles


def trifles_title(trifles: Sized) -> str:
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
            return f"at {torque:.7g} N m, misalignment {skew:.7g} µm"
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
        from_teeth, used = (1e3 * radius[name] for name in ("given", "used"))
        change = f"from {from_teeth:.6g} to {used:.6g} mm"
        yield f"base radius of {gear} corrected {change}: one base pitch per train"
    for check in attributes.get("effect_ledger", {}).get("checks", ()):
        if check["holds"] is False:
            part = check["part"] or check["effect"]
            yield f"VIOLATED: {check['assumption']} ({part}); {check['reason']}"


# The effect ledger of a scene in lines for people.


def effect_size(ledger: Json, effect: str) -> str:
    """Return what a scene loses without an effect in all its parts, in words: the one size that is shown.

    As the ledger of a run or a study estimates it; where it does not, how far flanks move at rest. Empty:
    nothing.
    """
    estimate = ledger.get("influences", {}).get(effect)
    if estimate is not None:
        return str(estimate["words"])
    largest = max(entry["influence_um"] for entry in ledger["entries"] if entry["effect"] == effect)
    return f"{engineering(largest, 3)} µm along the line of action at rest" if largest >= LEAST else ""


class SceneEffect(NamedTuple):
    """A decision about an effect and the parts that share it; the first has the size in all parts."""

    name: str
    on: bool
    size: str
    freedoms: str
    parts: str
    reason: str
    possible: bool


def scene_effects(ledger: Json) -> tuple[list[SceneEffect], list[SceneEffect]]:
    """Return the decisions on the effects of a scene, and apart those on what changes next to nothing."""
    estimates, effects = ledger.get("influences", {}), dict[str, list[Json]]()
    for entry in ledger.get("entries", ()):
        effects.setdefault(entry["effect"], []).append(entry)
    shown, trifles = list[SceneEffect](), list[SceneEffect]()
    for name, entries in effects.items():
        size, estimate = effect_size(ledger, name), estimates.get(name)
        freedoms = f"{estimate['freedoms']:+d}" if estimate else ""
        listed = trifles if _is_trifle(entries, size, estimate) else shown
        if estimate and estimate.get("level"):
            size = size.partition(", ")[0]
        listed += _decisions((name.replace("_", " "), size or "nothing", freedoms), entries)
    return shown, trifles


def scene_table(ledger: Json) -> tuple[list[str], list[list[str]], str]:
    """Return columns and a row for each effect of a scene, on or off, and what is said of the trifles.

    Where a level is estimated, it alone is the size. Parts of one reason have a line of the row.
    """
    effects, trifles = scene_effects(ledger)
    columns = ["effect", "on", "without it", "freedoms", "where and why"]
    rows = dict[tuple[str, bool], list[str]]()
    for effect in effects:
        cells = [effect.name, "yes" if effect.on else "no", effect.size, effect.freedoms, ""]
        row = rows.setdefault((effect.name, effect.on), cells)
        row[-1] = f"{row[-1]}\n{effect.parts}: {effect.reason}".lstrip()
    names = dict.fromkeys(effect.name for effect in trifles if effect.possible)
    return columns, [*rows.values()], f"{trifles_title(names)}: {', '.join(names)}" if names else ""


def beyond_lines(ledger: Json) -> Iterator[str]:
    """Yield why runs may change by more than the sizes of effects say, and of which effects."""
    effects = dict[str, list[str]]()
    for name, estimate in ledger.get("influences", {}).items():
        if beyond := estimate.get("beyond"):
            effects.setdefault(beyond, []).append(name.replace("_", " "))
    for beyond, names in effects.items():
        yield f"May change by more: {', '.join(names)}; {beyond}"


def assumed_lines(ledger: Json) -> Iterator[str]:
    """Yield what the phases of the meshes assume, part by part."""
    for row in ledger.get("assumed", ()):
        yield f"Assumed of {row['part']}: {row['words']}"


def _is_trifle(entries: list[Json], size: str, estimate: Json | None) -> bool:
    """Whether an effect is off everywhere and changes next to nothing."""
    if any(entry["on"] for entry in entries):
        return False
    if estimate is not None:
        changes = (*(estimate[name] for name in _RELATIVE), estimate.get("level", {}).get("relative", 0.0))
        return all(abs(change) < TRIFLE for change in changes)
    return not size


def _decisions(effect: tuple[str, str, str], entries: list[Json]) -> Iterator[SceneEffect]:
    """Yield each decision with its reason and price, and the parts that share it.

    `effect` are its name, size and freedoms.
    """
    shared: dict[tuple[bool, str], list[Json]] = {}
    for entry in entries:
        price = f"; price: {entry['price']}" if entry["on"] and entry.get("price") else ""
        shared.setdefault((entry["on"], f"{entry['reason']}{price}"), []).append(entry)
    possible = any(entry.get("possible", True) for entry in entries)
    name, size, freedoms = effect
    for (on, reason), same in shared.items():
        parts = ", ".join(entry["part"] for entry in same)
        yield SceneEffect(name, on, size, freedoms, parts, reason, possible)
        size = freedoms = ""
