"""Texts with one kind of damage, as files from outside have it."""

import builtins
import random
from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest

from lineofaction.gearbox.problems import BadInput


def damaged(text: str, seed: int) -> str:
    """Return a text with one kind of damage: bytes lost, turned or added, lines lost, mixed or doubled."""
    draw = random.Random(seed)
    lines = text.splitlines()
    at, row = draw.randrange(len(text)), draw.randrange(len(lines))
    junk = draw.choice(
        ["\0", "\x1b[2J", "/etc/passwd", "=cmd()", "\u202e", "1e999", '"', ",,,,", "\ufffd", "-"]
    )
    match seed % 6:
        case 0:
            return text[:at]
        case 1:
            return text[:at] + junk + text[at:]
        case 2:
            return text[:at] + text[at + draw.randrange(1, 40) :]
        case 3:
            return "\n".join(lines[:row] + lines[row + 1 :])
        case 4:
            draw.shuffle(lines)
            return "\n".join(lines)
        case _:
            cells = lines[row].split(",")
            cells[draw.randrange(len(cells))] = junk
            return "\n".join((*lines[:row], ",".join(cells), *lines[row + 1 :]))


def fates_of_a_hundred(text: str, take: Callable[[str], object], patch: pytest.MonkeyPatch) -> Counter[str]:
    """Count what became of damaged texts: taken, or refused with one short fault; none opens a file."""

    def never(*_: object, **__: object) -> Any:
        raise AssertionError("what is read as text opens no file")

    take(text)  # what a first call loads
    patch.setattr(builtins, "open", never)
    fates: Counter[str] = Counter()
    for seed in range(100):
        try:
            take(damaged(text, seed))
            fates["taken"] += 1
        except BadInput as error:
            assert len(error.faults) == 1
            assert len(str(error)) < 2000
            fates["refused"] += 1
    return fates
