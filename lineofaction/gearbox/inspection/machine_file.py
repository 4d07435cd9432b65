"""Traces and pitches as Klingelnberg's measuring machines export them: curve files, KS.MK.FILE (.mka).

The grammar follows public descriptions of exported files. A heading of lines ``code : label : values`` says
gear, and where traces begin and end; a trace is a line with tooth, flank and number of values, then the
values in um; pitches are tables by flank. What such a file does not say is assumed: points of a profile have
equal steps of roll length, places along the face are from the datum face, teeth count clockwise.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fe_contact.geometry import Toothing
from lineofaction.gearbox.inspection.sheet import LARGEST_UM, MAX_POINTS, OMITTED, Flank, Point, Sheet
from lineofaction.gearbox.units import MM, UM

_FIRST = re.compile(r"HEADER\s+KS\.MK\.FILE")
_HEADING = re.compile(r"\s*\d{1,3}\s*:(?P<label>[^:]*):(?P<values>.*)")
_PREAMBLE = re.compile(r"[A-Z]{3,}[A-Z ]*:?(\s|$)")
_NUMBER = re.compile(r"[-+]?(?:\d{1,12}\.?\d{0,12}|\.\d{1,12})(?:[eE][-+]?\d{1,2})?")
_BLOCK = re.compile(r"(?P<title>[A-Za-zäöüÄÖÜß]{3,20}):")
_TRACE = re.compile(
    r"(?:(?P<title>[A-Za-zäöüÄÖÜß]{3,20}):\s*)?Zahn-Nr\.?:\s*(?P<tooth>\d{1,4})(?P<tag>[a-z]?)\s*"
    r"(?:/\s*[A-Za-zäöü]+:\d+\s*)?(?P<flank>links|rechts)\s*/\s*(?P<count>\d{1,6})\s+Werte\s*/?\s*[a-z]=.*"
)
_PITCHES = re.compile(r"(?P<flank>linke|rechte) Zahnflanke")
_ROW = re.compile(r"\s*(?P<tooth>\d{1,4})((?:\s+[-+]?\d*\.?\d+){3})\s*")
_UNDEFINED = -2e6
"""Value below which the machine marks a point as not measured."""
_FLANKS: dict[str, Flank] = {"links": "left", "rechts": "right", "linke": "left", "rechte": "right"}
_KINDS = {"Profil": "profile", "Flankenlinie": "helix"}
_ENDS = {"profile": ("da", "de"), "helix": ("ba", "be")}
"""Symbols of begin and end of a trace in the heading, mm: diameters, and places along the face."""
OTHER_TRACE = f"{OMITTED}a trace of twist or topography"
UNMEASURED = f"{OMITTED}not measured by the machine"
UNKNOWN = f"{OMITTED}a line that is not understood"
_OTHER = "other table or heading"


def is_machine_file(text: str) -> bool:
    """Return whether a text begins as a curve file of a measuring machine."""
    return _FIRST.match(text.removeprefix("\ufeff").lstrip()) is not None


def machine_sheet(text: str, gear: Toothing) -> Sheet:
    """Return the points of profiles, helices and pitches that a curve file holds, of a gear.

    Raises `ValueError`: what the file must hold and which line does not.
    """
    return _Reader(text.removeprefix("\ufeff").splitlines(), gear).sheet()


class _Trace(NamedTuple):
    line: int
    kind: str | None
    tooth: int
    flank: Flank
    values: int


@dataclass
class _Reader:
    """Goes through the lines of a file once."""

    lines: list[str]
    gear: Toothing

    def sheet(self) -> Sheet:
        self.ends: dict[str, list[float]] = {}
        self.account: Counter[str] = Counter()
        points: list[Point] = []
        title, at = "", 0
        while at < len(self.lines):
            line = self.lines[at].strip()
            at += 1
            if match := _TRACE.fullmatch(line):
                title = match["title"] or title
                trace = self._trace(match, title, at)
                values, at = self._values(trace, at)
                points += self._placed(trace, values)
            elif match := _PITCHES.fullmatch(line):
                rows, at = self._rows(at)
                points += self._pitches(_FLANKS[match["flank"]], rows)
            else:
                title = self._title(line, at) or title
            if len(points) > MAX_POINTS:
                raise ValueError(f"a file of at most {MAX_POINTS} points")
        if not points:
            raise ValueError("a file with a profile, a helix or pitches; it has none")
        return Sheet(tuple(points), self.account)

    def _title(self, line: str, number: int) -> str:
        """Take a line that is neither trace nor pitch; returns the title of traces that it is."""
        if match := _BLOCK.fullmatch(line):
            self.account["heading"] += 1
            return match["title"]
        if match := _HEADING.fullmatch(line):
            self._heading(match["label"], [float(text) for text in _NUMBER.findall(match["values"])], number)
            self.account["heading"] += 1
        elif not line:
            self.account["comment or blank"] += 1
        elif _FIRST.match(line) or _PREAMBLE.match(line):
            self.account["heading"] += 1
        else:
            known = re.match(r"(Fuß|Kopf)kreisdurchmesser|Zahn-Nr|Z-Nr|[-+.\d\sLR]+$", line)
            self.account[_OTHER if known else UNKNOWN] += 1
        return ""

    def _heading(self, label: str, values: list[float], number: int) -> None:
        """Keep where traces begin and end; refuse the file of another gear."""
        if "hnezahl" in label and values and abs(values[0]) != self.gear.teeth:
            raise ValueError(
                f"the file of a gear of {self.gear.teeth} teeth; line {number} has {values[0]:g}"
            )
        if "Normalmodul" in label and values and abs(values[0] * MM / self.gear.normal_module - 1.0) > 1e-3:
            module = self.gear.normal_module / MM
            raise ValueError(f"the file of a gear of module {module:g} mm; line {number} has {values[0]:g}")
        for symbol in (name for ends in _ENDS.values() for name in ends):
            if re.search(rf"\b{symbol}\s*\[mm\]", label) and values:
                self.ends[symbol] = values[:2]

    def _trace(self, match: re.Match[str], title: str, line: int) -> _Trace:
        tooth, count = int(match["tooth"]), int(match["count"])
        if not 1 <= tooth <= self.gear.teeth:
            raise ValueError(f"a file of teeth from 1 to {self.gear.teeth}; line {line} has {tooth}")
        kind = None if match["tag"] else _KINDS.get(title)
        return _Trace(line, kind, tooth, _FLANKS[match["flank"]], count)

    def _values(self, trace: _Trace, at: int) -> tuple[list[tuple[int, float]], int]:
        """Return the values of a trace after the line of each, and the line after them."""
        values: list[tuple[int, float]] = []
        while len(values) < trace.values and at < len(self.lines):
            texts = self.lines[at].split()
            at += 1
            if not all(_NUMBER.fullmatch(text) for text in texts):
                raise ValueError(
                    f"a file of {trace.values} values in the trace of line {trace.line}; line {at} is none"
                )
            values += [(at, float(text)) for text in texts]
        if len(values) != trace.values:
            raise ValueError(
                f"a file of {trace.values} values in the trace of line {trace.line}; there are {len(values)}"
            )
        return values, at

    def _placed(self, trace: _Trace, values: list[tuple[int, float]]) -> Iterator[Point]:
        if trace.kind is None:
            self.account[OTHER_TRACE] += len(values)
            return
        start, end = (self._end(symbol, trace) for symbol in _ENDS[trace.kind])
        if trace.kind == "profile":
            start, end = (self._roll(diameter, trace) for diameter in (start, end))
        else:
            start, end = (coordinate * MM - 0.5 * self.gear.face_width for coordinate in (start, end))
        for coordinate, (line, value) in zip(np.linspace(start, end, trace.values), values, strict=True):
            if value < _UNDEFINED:
                self.account[UNMEASURED] += 1
                continue
            if abs(value) > LARGEST_UM:
                raise ValueError(f"a file of deviations up to {LARGEST_UM:g} µm; line {line} has {value:g}")
            roll, face = (float(coordinate), None) if trace.kind == "profile" else (None, float(coordinate))
            yield Point(line, trace.tooth, trace.flank, trace.kind, roll, face, value * UM)

    def _end(self, symbol: str, trace: _Trace) -> float:
        values = self.ends.get(symbol)
        if values is None:
            raise ValueError(
                f"a file whose heading has {symbol} [mm]; the trace of line {trace.line} needs it"
            )
        return values[0] if trace.flank == "left" else values[-1]

    def _roll(self, diameter: float, trace: _Trace) -> float:
        radius, base = 0.5 * diameter * MM, self.gear.base_radius
        if not base <= radius < 1e3:
            raise ValueError(
                f"a file of diameters from {2.0 * base / MM:.6g} mm on; the trace of line {trace.line} "
                f"has {diameter:g}"
            )
        return math.sqrt(radius**2 - base**2)

    def _rows(self, at: int) -> tuple[list[tuple[int, int, float]], int]:
        """Return line, tooth and cumulative pitch of the rows of a table, and the line after them."""
        rows: list[tuple[int, int, float]] = []
        while at < len(self.lines):
            line = self.lines[at]
            match = _ROW.fullmatch(line)
            if match:
                rows.append((at + 1, int(match["tooth"]), float(match[2].split()[1])))
            elif line.strip() and (rows or not line.strip().startswith("Zahn-Nr")):
                break
            else:
                self.account["comment or blank" if not line.strip() else _OTHER] += 1
            at += 1
        return rows, at

    def _pitches(self, flank: Flank, rows: list[tuple[int, int, float]]) -> Iterator[Point]:
        for count, (line, tooth, value) in enumerate(rows, 1):
            if tooth != count or tooth > self.gear.teeth or abs(value) > LARGEST_UM:
                raise ValueError(
                    f"a file with the pitches of teeth 1 to {self.gear.teeth} in turn; line {line} is none"
                )
            yield Point(line, tooth, flank, "cumulative_pitch", None, None, value * UM)
