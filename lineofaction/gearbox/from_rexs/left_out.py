"""What a file has and its scene has not: every refused line of the account, by its reason."""

from __future__ import annotations

from collections.abc import Iterable

from lineofaction.gearbox.from_rexs.account import Line
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.rexs.vocabulary import words

MOST, LONGEST = 100, 2000
"""Statements of a unit, and characters of one."""
_NO_REASON = "no part of the scene is made of it"
_OF_TYPE = {
    "cylindrical_gear": "it is in no stage of the scene",
    "ring_gear": "it is in no stage of the scene",
    "external_load": "it acts on no shaft of the scene",
    "side_plate": "it is part of no planet carrier of the scene",
}


def say_left_out(unit: GearUnit) -> None:
    """State of every part of which nothing is said that the scene has not got it."""
    descriptive = words("descriptive_components")
    for component in unit.model.components:
        if component.type not in descriptive and not unit.account.is_stated(component):
            reason = _OF_TYPE.get(component.type, _NO_REASON)
            Part(component, unit.account).say("", "refused", reason)


def headline(lines: Iterable[Line]) -> str:
    """Return all that is left out on one line, with its attributes in brackets; empty for nothing."""
    parts: dict[str, list[str]] = {}
    for line in _refused(lines):
        parts.setdefault(_named(line), []).append(line.item)
    texts = [f"{named}{_brackets(filter(None, items))}" for named, items in parts.items()]
    return f"left out of the scene: {'; '.join(texts)}" if parts else ""


def statements(lines: Iterable[Line]) -> tuple[str, ...]:
    """Return what is left out with lines of the file and the reason, a sentence for each reason.

    Stages come first, for what stands behind them is left out with them; then other parts, then values of
    parts, each in the order of the file.
    """
    groups: dict[str, list[Line]] = {}
    for line in _refused(lines):
        groups.setdefault(line.words, []).append(line)
    texts = [_statement(group, reason) for reason, group in groups.items()]
    rest = len(texts) - MOST
    return tuple(texts if rest <= 0 else [*texts[:MOST], f"and {rest} more: see the account of the import"])


def _refused(lines: Iterable[Line]) -> list[Line]:
    """Return the refused lines: stages, other parts, values of parts."""
    refused = (line for line in lines if line.fate == "refused")
    return sorted(refused, key=lambda line: (bool(line.item), not line.kind.endswith("_stage")))


def _statement(group: list[Line], reason: str) -> str:
    """Return what is left out for one reason, with the lines of the file if it has lines."""
    lines = {line: "" if line.line is None else f" (line {line.line})" for line in group}
    named = "; ".join(
        f"{_named(line)}{place}{f', {line.item}' if line.item else ''}" for line, place in lines.items()
    )
    most = max(LONGEST - len(reason) - 2, LONGEST // 2)
    named = named if len(named) <= most else f"{named[: most - 4]} ..."
    return f"{named}: {reason}"[:LONGEST]


def _named(line: Line) -> str:
    return f"{line.kind} {line.component}" + (f' "{line.name}"' if line.name else "")


def _brackets(items: Iterable[str]) -> str:
    text = ", ".join(dict.fromkeys(items))
    return f" ({text})" if text else ""
