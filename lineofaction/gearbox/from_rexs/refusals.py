"""Refusals of an import: parts of a file that its scene lacks, by the reason."""

from __future__ import annotations

from collections.abc import Iterable

from lineofaction.gearbox.from_rexs.account import Line

MAX, LONGEST = 100, 2000
"""Largest number of sentences, and of characters in a sentence."""

NO_REASON = "no part of the scene is made of it"

REASONS = {
    "cylindrical_gear": "it is in no stage of the scene",
    "ring_gear": "it is in no stage of the scene",
    "external_load": "it acts on no shaft of the scene",
    "side_plate": "it is part of no planet carrier of the scene",
}


def refusal_texts(lines: Iterable[Line]) -> tuple[str, ...]:
    """Return sentences on omitted parts with lines of the file, one sentence for each reason.

    Stages come first, for what stands behind them is left out with them; then other parts, then values of
    parts, each in the order of the file.
    """
    groups: dict[str, list[Line]] = {}
    for line in refused_lines(lines):
        groups.setdefault(line.words, []).append(line)
    texts = [_statement(group, reason) for reason, group in groups.items()]
    rest = len(texts) - MAX
    return tuple(texts if rest <= 0 else [*texts[:MAX], f"and {rest} more: see the account of the import"])


def refused_lines(lines: Iterable[Line]) -> list[Line]:
    """Return the refused lines: stages, other parts, values of parts."""
    refused = (line for line in lines if line.fate == "refused")
    return sorted(refused, key=lambda line: (bool(line.item), not line.kind.endswith("_stage")))


def _statement(group: list[Line], reason: str) -> str:
    names = []
    for line in dict.fromkeys(group):
        location = "" if line.line is None else f" (line {line.line})"
        item = f", {line.item}" if line.item else ""
        names.append(f"{line_name(line)}{location}{item}")
    text = "; ".join(names)
    room = max(LONGEST - len(reason) - 2, LONGEST // 2)
    text = text if len(text) <= room else f"{text[: room - 4]} ..."
    return f"{text}: {reason}"[:LONGEST]


def line_name(line: Line) -> str:
    """Return type, id and name of the component of a line."""
    return f"{line.kind} {line.component}" + (f' "{line.name}"' if line.name else "")
