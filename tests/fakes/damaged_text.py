"""Texts with one kind of damage, as files from outside have it."""

from __future__ import annotations

import random


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
