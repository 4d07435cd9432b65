"""Results as Klingelnberg's measuring machines print them: value files, KS.MW.FILE (.mew).

The heading is that of the curve file. A result is a numbered line ``20115 : fHa links 44 : 13.7``, in um:
profile and lead by tooth and flank (links: left, rechts: right), pitches by flank, run-out Fr by neither.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

from lineofaction.gearbox.inspection.machine_heading import NUMBER, Conventions, Heading
from lineofaction.gearbox.inspection.sheet import Flank

_FIRST = re.compile(r"HEADER\s+KS\.MW\.FILE")
_RESULT = re.compile(r"(?P<line>\d{5})\s*:(?P<label>[^:]{1,40}):(?P<value>.{0,40})")
_TOOTH = re.compile(r"(?P<figure>fHa|ffa|Fa|fHb|ffb|Fb)\s+(?P<flank>links|rechts)\s+(?P<tooth>\d{1,4})")
_PITCH = re.compile(r"(?P<figure>fp max|fu max|Rp|Fpz/8|Fp)\s+(?P<flank>links|rechts)")
_FLANKS: dict[str, Flank] = {"links": "left", "rechts": "right"}
_NO_VALUES = (-9999.0, 8999.0)
"""Numbers that stand for a missing value: not measured, and no mean or maximum formed."""
_IDENTITY = (2, 3, 7)
"""Lines of the heading with date, time and number of the gear."""
_MOST_LINES = 20_000
"""Lines above which a text is refused before it is read."""
_LABEL_OF_RUN_OUT = "Fr"
_TEETH_LABEL, _TEETH_LINE = "hnezahl z", "22"
"""End of "Zähnezahl z" (number of teeth z), whose umlaut depends on the coding, and number of its line."""
_MAX_TEETH = 2000
"""Largest number of teeth that a heading may state."""


class Printed(NamedTuple):
    """A result that a machine printed, um."""

    line: int
    figure: str
    flank: Flank | None
    tooth: int
    """Tooth as the machine counts it, or 0: a result of all teeth."""
    value: float


@dataclass(frozen=True)
class ValueFile:
    """Results of a gear, and the lines of the heading that name the gear."""

    conventions: Conventions
    identity: tuple[str, ...]
    teeth: int
    printed: tuple[Printed, ...]


def is_value_file(text: str) -> bool:
    """Return whether a text begins as a value file of a measuring machine."""
    return _FIRST.match(text.removeprefix("\ufeff").lstrip()) is not None


def value_file(text: str) -> ValueFile:
    """Return what a value file holds.

    Raises `ValueError`: what the file must hold and which line does not.
    """
    if not is_value_file(text):
        raise ValueError("a value file of a measuring machine, which begins with HEADER KS.MW.FILE")
    lines = text.removeprefix("\ufeff").splitlines()
    if len(lines) > _MOST_LINES:
        raise ValueError(f"a value file of at most {_MOST_LINES} lines")
    heading = Heading()
    printed: list[Printed] = []
    seen: dict[tuple[str, Flank | None, int], int] = {}
    for number, line in enumerate(lines, 1):
        result = printed_value(line.strip(), number)
        if result is None:
            heading.take(line, number)
            continue
        key = (result.figure, result.flank, result.tooth)
        if key in seen:
            raise ValueError(
                f"a value file that prints each result once; line {number} repeats line {seen[key]}"
            )
        seen[key] = number
        printed.append(result)
    if not printed:
        raise ValueError("a value file with results; it has none")
    return ValueFile(heading.conventions(), identity(lines), _teeth(lines), tuple(printed))


def printed_value(line: str, number: int) -> Printed | None:
    """Return the result of a line or None; raises `ValueError`: a result that is no number."""
    match = _RESULT.fullmatch(line)
    if match is None:
        return None
    label = match["label"].strip()
    named = _TOOTH.fullmatch(label) or _PITCH.fullmatch(label)
    if named is None and label != _LABEL_OF_RUN_OUT:
        return None
    text = match["value"].strip()
    if not NUMBER.fullmatch(text):
        raise ValueError(f"a file whose results are numbers; line {number} has {text!r}")
    if float(text) in _NO_VALUES:
        return None
    parts = {} if named is None else named.groupdict()
    flank = _FLANKS[parts["flank"]] if parts else None
    return Printed(
        number, parts.get("figure", _LABEL_OF_RUN_OUT), flank, int(parts.get("tooth") or 0), float(text)
    )


def identity(lines: Iterable[str]) -> tuple[str, ...]:
    """Return date, time and number of a gear as a heading has them."""
    texts = dict.fromkeys(_IDENTITY, "")
    for line in lines:
        code, colon, text = line.partition(":")
        # a short code, so that no endless row of digits is read as a number
        if colon and code.strip().isdecimal() and len(code) < 8 and int(code) in texts:
            texts[int(code)] = " ".join(text.split())
    return tuple(texts.values())


def _teeth(lines: Iterable[str]) -> int:
    for number, line in enumerate(lines, 1):
        label, _, rest = line.partition(_TEETH_LABEL)
        if rest and label.strip()[:2] == _TEETH_LINE:
            values = NUMBER.findall(rest)
            if values and 1 <= float(values[0]) <= _MAX_TEETH:
                return int(float(values[0]))
            raise ValueError(f"a value file of a gear of 1 to {_MAX_TEETH} teeth; line {number} has none")
    raise ValueError("a value file whose heading has the number of teeth; it has none")
