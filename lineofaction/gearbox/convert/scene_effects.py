"""The effect ledger of a scene as text.

The ledger lists, for every effect and every part of the scene, whether the effect is on and why. The *size*
of an effect is text: how much a result changes without it. A *negligible* effect is off everywhere and would
change next to nothing. *Freedoms* are the degrees of freedom that an effect adds to the model.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from bounds import engineering
from lineofaction.gearbox.convert.effects import _RELATIVE, MIN, Json, trifles_title
from model_studies.ablation import TRIFLE


def effect_size(ledger: Json, effect: str) -> str:
    """Return the influence of an effect in all parts of a scene, as text.

    It is the estimate of a run or a study where the ledger has one, else the largest displacement of a flank
    at rest. The text is empty where the effect changes nothing.
    """
    estimate = ledger.get("influences", {}).get(effect)
    if estimate is not None:
        return str(estimate["words"])
    largest = max(entry["influence_um"] for entry in ledger["entries"] if entry["effect"] == effect)
    return f"{engineering(largest, 3)} µm along the line of action at rest" if largest >= MIN else ""


class SceneEffect(NamedTuple):
    """A decision about an effect and the parts that share it.

    `size` and `freedoms` are those in all parts of the scene; only the first decision about an effect has
    them. `possible` is False where no part allows the effect.
    """

    name: str
    on: bool
    size: str
    freedoms: str
    parts: str
    reason: str
    possible: bool


def scene_effects(ledger: Json) -> tuple[list[SceneEffect], list[SceneEffect]]:
    """Return the decisions on the effects of a scene, and separately on effects of negligible size."""
    effects = dict[str, list[Json]]()
    for entry in ledger.get("entries", ()):
        effects.setdefault(entry["effect"], []).append(entry)
    main, trifles = list[SceneEffect](), list[SceneEffect]()
    for name, entries in effects.items():
        size = effect_size(ledger, name)
        estimate = ledger.get("influences", {}).get(name)
        freedoms = f"{estimate['freedoms']:+d}".replace("+0", "0") if estimate else ""
        listed = trifles if _is_trifle(entries, size, estimate) else main
        if estimate and estimate.get("level"):
            size = size.partition(", ")[0]  # the text begins with the level, which is enough
        listed.extend(_decisions(name.replace("_", " "), size or "nothing", freedoms, entries))
    return main, trifles


def scene_table(ledger: Json) -> tuple[list[str], list[list[str]], str]:
    """Return columns and a row for each effect of a scene, on or off, and a line on negligible effects.

    Where a level is estimated, it alone is the size. The last cell has a line for each reason and its parts.
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
    """Yield a line for each reason why a run may change by more than the stated sizes of some effects."""
    effects = dict[str, list[str]]()
    for name, estimate in ledger.get("influences", {}).items():
        if beyond := estimate.get("beyond"):
            effects.setdefault(beyond, []).append(name.replace("_", " "))
    for beyond, names in effects.items():
        yield f"May change by more: {', '.join(names)}; {beyond}"


def assumed_lines(ledger: Json) -> Iterator[str]:
    """Yield lines on the assumed phases of the meshes, part by part."""
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


def _decisions(name: str, size: str, freedoms: str, entries: list[Json]) -> Iterator[SceneEffect]:
    """Yield each decision about an effect with its reason and price, and the parts that share it."""
    shared: dict[tuple[bool, str], list[Json]] = {}
    for entry in entries:
        price = f"; price: {entry['price']}" if entry["on"] and entry.get("price") else ""
        shared.setdefault((entry["on"], f"{entry['reason']}{price}"), []).append(entry)
    possible = any(entry.get("possible", True) for entry in entries)
    for (on, reason), same in shared.items():
        parts = ", ".join(entry["part"] for entry in same)
        yield SceneEffect(name, on, size, freedoms, parts, reason, possible)
        size = freedoms = ""  # the first decision alone has them
