"""The heading of a file of a Klingelnberg machine: the conventions of its values, in one record.

A heading has a preamble, as ``UNITS mm``, and numbered lines ``161 :label :NAME: value``. A statement that
decides how values are read has a row in `STATEMENTS` with the values whose meaning is known. Another value is
refused by the number of its line, and so is a heading without the statement.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

from lineofaction.gearbox.inspection.sheet import Flank

NUMBER = re.compile(r"[-+]?(?:\d{1,12}\.?\d{0,12}|\.\d{1,12})(?:[eE][-+]?\d{1,2})?")
_PREAMBLE = re.compile(r"(?P<name>[A-Z]{3,}(?: [A-Z]+)?)(?:\s+|:\s*|$)(?P<value>[^!]*)(?:!.*)?")
_NUMBERED = re.compile(r"\s*\d{1,3}\s*:(?P<text>.*)")
_NAMED = re.compile(r":\s*(?P<name>[A-Z][A-Z_0-9]{2,5})\s*:(?P<value>.*)")
_DIMENSION = re.compile(r"\b(?P<symbol>d[ae12]|b[ae12]|dk2)\s*\[mm\]\W*:(?P<values>.*)")
_KINDS = {"profile": ("da", "d1", "d2", "de", "dk2"), "helix": ("ba", "b1", "b2", "be", "")}
"""Symbols of a trace: begin, evaluated from and to, end; end of the relief of the tip."""


class Statement(NamedTuple):
    """Convention that a heading must state, and the meanings of its known values."""

    line: str
    """Number of the line in the heading, or empty: a line of the preamble."""
    subject: str
    known: Mapping[str, str]
    """Meaning by the value, written without blanks."""


STATEMENTS = {
    "UNITS": Statement("", "units", {"mm": "millimeters"}),
    "ANGLE": Statement("", "angles", {"decimal": "decimal degrees"}),
    "PROFILE": Statement("", "places along the profile", {"diameter": "diameters"}),
    "FILTER LEAD": Statement("", "filter of leads", {"F:S2": "leads are stored as they are evaluated"}),
    "FILTER PROFILE": Statement("", "filter of profiles", {"F:S2": "profiles are stored as evaluated"}),
    "ZRICH": Statement("161", "direction of counting", {"0": "clockwise", "1": "counterclockwise"}),
    "ZVERT": Statement("162", "distribution of teeth", {"0": "DIN"}),
    "ZZALU": Statement("163", "tooth or gap", {"0": "teeth are counted"}),
    "ZSDEF": Statement("164", "sides", {"0": "left and right by VDI/DIN"}),
    "R_FHB": Statement("165", "reference of f_Hbeta", {"1:L:+:R:-": "DIN"}),
    "LVORZ": Statement("178", "sign of leads", {"1:DIN": "DIN"}),
    "BZGFL": Statement("179", "length of f_Hbeta", {"1:Z": "face width"}),
    "BZGPR": Statement("180", "length of f_Halpha", {"0:M1-M2": "evaluated length"}),
    "PLMFL": Statement("181", "material of leads", {"0:0:1": "as printed"}),
    "PLMPR": Statement("182", "material of profiles", {"0:0:1": "as printed"}),
    "SCHNT": Statement("183", "section", {"0": "transverse"}),
    "ZTURN": Statement("244", "clamping", {"0": "not turned over"}),
}


@dataclass(frozen=True)
class TraceRange:
    """Measured range, `begin` to `end`, and evaluated range, `first` to `last`: diameters or heights, mm."""

    begin: float
    first: float
    last: float
    end: float
    relief_end: float
    """`last`, or beyond it the end of the tip relief that the heading states."""


@dataclass(frozen=True)
class Conventions:
    """Conventions and ranges that a heading states for the values of its file."""

    meanings: Mapping[str, str]
    """Meaning of each statement by its name."""
    ranges: Mapping[tuple[str, Flank], TraceRange]
    """Ranges by kind and flank; a kind without ranges has no traces."""
    undefined: float
    """Value of a point that was not measured."""

    @property
    def clockwise(self) -> bool:
        """Return whether teeth are counted clockwise as seen from above."""
        return self.meanings["ZRICH"] == "clockwise"


@dataclass
class Heading:
    """Takes the lines of a heading, and gives the conventions that they state."""

    statements: dict[str, tuple[int, str]] = field(default_factory=dict)
    """Number of the line and value, by the name of the statement."""
    dimensions: dict[str, tuple[float, float]] = field(default_factory=dict)
    """Values of the left and of the right flank by their symbols, mm."""
    dimension_lines: dict[str, int] = field(default_factory=dict)

    def take(self, line: str, number: int) -> str | None:
        """Take a line; returns the text behind its number, or None if it is no line of a heading."""
        if match := _NUMBERED.fullmatch(line):
            text = match["text"]
            if named := _NAMED.search(text):
                self._state(named["name"], named["value"], number)
            if dimension := _DIMENSION.search(text):
                self._measure(dimension["symbol"], dimension["values"], number)
            return text
        if match := _PREAMBLE.fullmatch(line.strip()):
            self._state(match["name"], match["value"], number)
            return line.strip()
        return None

    def conventions(self) -> Conventions:
        """Return what the heading states; raises `ValueError` by the line that is missing or unknown."""
        meanings = {name: self._meaning(name, statement) for name, statement in STATEMENTS.items()}
        line, undefined = self.statements.get("UNDEFINED", (0, ""))
        if not NUMBER.fullmatch(undefined):
            raise ValueError(f"a file with UNDEFINED and a number; {_found(line, undefined)}")
        return Conventions(meanings, dict(self._ranges()), float(undefined))

    def _state(self, name: str, text: str, number: int) -> None:
        value = re.sub(r"\s+", "", text)
        line, before = self.statements.setdefault(name, (number, value))
        if before != value and (name in STATEMENTS or name == "UNDEFINED"):
            raise ValueError(f"a file that states {name} once; lines {line} and {number} differ")

    def _measure(self, symbol: str, text: str, number: int) -> None:
        values = [float(value) for value in NUMBER.findall(text)]
        if len(values) not in (1, 2):
            raise ValueError(f"a file with {symbol} [mm] of one or both flanks; {_found(number, text)}")
        pair = (values[0], values[-1])
        if self.dimensions.setdefault(symbol, pair) != pair:
            raise ValueError(f"a file that states {symbol} once; line {number} states it again")
        self.dimension_lines[symbol] = number

    def _meaning(self, name: str, statement: Statement) -> str:
        line, value = self.statements.get(name, (0, ""))
        if value not in statement.known:
            known = " or ".join(f"{value} ({meaning})" for value, meaning in statement.known.items())
            location = f"line {statement.line} of the heading" if statement.line else "the preamble"
            bound = f"a file whose {name} ({statement.subject}, {location}) is {known}"
            raise ValueError(f"{bound}; {_found(line, value)}")
        return statement.known[value]

    def _ranges(self) -> Iterator[tuple[tuple[str, Flank], TraceRange]]:
        flanks: tuple[Flank, ...] = ("left", "right")
        for kind, (*symbols, relief) in _KINDS.items():
            if not all(symbol in self.dimensions for symbol in symbols):
                continue
            for side, flank in enumerate(flanks):
                ends = [self.dimensions[symbol][side] for symbol in symbols]
                begin, first, last, end = ends
                if not all(low <= high for low, high in pairwise(ends)) or first >= last:
                    line = max(self.dimension_lines[symbol] for symbol in symbols)
                    raise ValueError(f"a file with {' <= '.join(symbols)}; up to line {line} they are {ends}")
                reliefs = self.dimensions.get(relief, (-math.inf, -math.inf))
                relief_end = min(end, max(last, reliefs[side]))
                yield (kind, flank), TraceRange(begin, first, last, end, relief_end)


def _found(line: int, value: str) -> str:
    return f"line {line} has {value[:40]!r}" if line else "it has none"
