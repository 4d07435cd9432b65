"""Traces and pitches as Klingelnberg's measuring machines export them: curve files, KS.MK.FILE (.mka).

The heading says gear, ranges and conventions (`machine_heading`). A trace is a line with tooth, flank and
number of values, then the values in um; pitches are tables by flank.

The machine sees the gear from above: left and right flanks, and the direction in which it counts teeth.
Values of a profile are material on right flanks, minus the material on left flanks; so are those of a lead.
Points of a profile have equal steps of roll length, those of a lead equal steps from the lower end up.
Pitches are positive in the direction of counting.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import Toothing
from fe_contact.types import FloatArray
from lineofaction.gearbox.inspection.machine_heading import NUMBER, Conventions, Heading, TraceRange
from lineofaction.gearbox.inspection.machine_values import Printed, printed_value
from lineofaction.gearbox.inspection.sheet import (
    LARGEST_UM,
    MAX_POINTS,
    OMITTED,
    Flank,
    Interval,
    Point,
    Sheet,
)
from lineofaction.gearbox.units import MM, UM

MATERIAL: dict[Flank, int] = {"left": -1, "right": 1}
"""Sign of material in excess in the values of a trace."""
# Lines of the file: its first line, the title of a block, the line before the values of a trace ("Zahn-Nr."
# is the number of the tooth, "Werte" are values), the title of a table of pitches, and a row of it.
_FIRST = re.compile(r"HEADER\s+KS\.MK\.FILE")
_BLOCK = re.compile(r"(?P<title>[A-Za-zäöüÄÖÜß]{3,20}):")
_TRACE = re.compile(
    r"(?:(?P<title>[A-Za-zäöüÄÖÜß]{3,20}):\s*)?Zahn-Nr\.?:\s*(?P<tooth>\d{1,4})(?P<tag>[a-z]?)\s*"
    r"(?:/\s*[A-Za-zäöü]+:\d+\s*)?(?P<flank>links|rechts)\s*/\s*(?P<count>\d{1,6})\s+Werte\s*/?\s*[a-z]=.*"
)
_PITCHES = re.compile(r"(?P<flank>linke|rechte) Zahnflanke")
_ROW = re.compile(r"\s*(?P<tooth>\d{1,4})(?P<values>(?:\s+[-+]?\d{0,9}\.?\d{1,9}){3})\s*")
_FLANKS: dict[str, Flank] = {"links": "left", "rechts": "right", "linke": "left", "rechte": "right"}
_KINDS = {"Profil": "profile", "Flankenlinie": "helix"}
OTHER_TRACE = f"{OMITTED}a trace of twist or topography"
UNMEASURED = f"{OMITTED}not measured by the machine"
UNKNOWN = f"{OMITTED}a line that is not understood"
OUTSIDE = "outside the evaluated range"
_OTHER = "other table or heading"
_ROUNDING_M = 1e-9
"""A point this far beyond the evaluated range is in it, m."""
_MODULE_ERROR = 1e-3
"""Largest relative difference of the file's module from that of the gear."""


@dataclass(frozen=True)
class Trace:
    """A trace as the file has it."""

    line: int
    """Number of the line with tooth and flank."""
    kind: str | None
    """"profile" or "helix"; None: a trace of twist or topography."""
    tooth: int
    flank: Flank
    values: FloatArray
    """Deviations in um, with the sign of the file."""
    lines: tuple[int, ...]
    """Number of the line of each value."""


@dataclass(frozen=True)
class PitchTable:
    """The pitches of one flank as the file has them: f_p, F_p and F_r (z, 3), um."""

    flank: Flank
    lines: tuple[int, ...]
    values: FloatArray


@dataclass(frozen=True)
class MachineFile:
    """Content of a curve file."""

    conventions: Conventions
    """Ranges and directions, from the heading."""
    traces: tuple[Trace, ...]
    tables: tuple[PitchTable, ...]
    printed: tuple[Printed, ...]
    """Results that the machine has printed into the file."""
    account: Mapping[str, int]
    """Number of lines by their meaning, such as "heading"."""


def is_machine_file(text: str) -> bool:
    """Return whether a text begins as a curve file of a measuring machine."""
    return _FIRST.match(text.removeprefix("\ufeff").lstrip()) is not None


def machine_file(text: str, gear: Toothing) -> MachineFile:
    """Return the content of a curve file of a gear.

    Raises `ValueError`: the text names the file that is expected, and the line that differs.
    """
    if gear.sign < 0:
        raise ValueError("the file of an external gear; conventions of internal gears are not known")
    return _Reader(text.removeprefix("\ufeff").splitlines(), gear).file()


def machine_sheet(file: MachineFile, gear: Toothing) -> Sheet:
    """Return the points of profiles, leads and pitches of a file as a sheet has them.

    They are those of the range that the machine evaluates, and of the tip relief beyond it that the heading
    states. Raises `ValueError`: an impossible value, or a file without any.
    """
    account = Counter(file.account)
    points: list[Point] = []
    for trace in file.traces:
        points += _trace_points(trace, file.conventions, gear, account)
    for table in file.tables:
        points += _pitch_points(table, file.conventions, gear)
    if not points:
        raise ValueError("a file with a profile, a helix or pitches; it has none")
    intervals = {key: _interval(key[0], ends, gear) for key, ends in file.conventions.ranges.items()}
    return Sheet(tuple(points), account, intervals)


def places(trace: Trace, conventions: Conventions, gear: Toothing) -> FloatArray:
    """Return roll lengths of a profile, or heights above the lower end of a lead, in m."""
    ends = trace_range(trace, conventions)
    start, stop = (place(trace.kind, end, gear) for end in (ends.begin, ends.end))
    return np.linspace(start, stop, trace.values.size)


def place(kind: str | None, dimension: float, gear: Toothing) -> float:
    """Return the roll length, m, of a diameter on a profile, or the height, m, on a lead; both from mm."""
    if kind != "profile":
        return dimension * MM
    radius, base = 0.5 * dimension * MM, gear.base_radius
    if not base <= radius < 1e3:
        raise ValueError(
            f"a file of diameters from {2.0 * base / MM:.6g} mm on; its heading has {dimension:g}"
        )
    return math.sqrt(radius**2 - base**2)


def trace_range(trace: Trace, conventions: Conventions) -> TraceRange:
    """Return the ranges of a trace; raises `ValueError` if the heading has none."""
    ends = conventions.ranges.get((trace.kind or "", trace.flank))
    if ends is None:
        symbols = "da, d1, d2, de" if trace.kind == "profile" else "ba, b1, b2, be"
        raise ValueError(
            f"a file whose heading has {symbols} [mm]; the trace of line {trace.line} needs them"
        )
    return ends


def _interval(kind: str, ends: TraceRange, gear: Toothing) -> Interval:
    first, last, begin, end = (
        place(kind, end, gear) for end in (ends.first, ends.last, ends.begin, ends.end)
    )
    if kind == "profile":
        return Interval(first, last, last - first)
    half = 0.5 * gear.face_width
    return Interval(half - last, half - first, end - begin)


def _trace_points(
    trace: Trace, conventions: Conventions, gear: Toothing, account: Counter[str]
) -> Iterator[Point]:
    """Yield the evaluated points of a trace."""
    if trace.kind is None:
        account[OTHER_TRACE] += trace.values.size
        return
    ends = trace_range(trace, conventions)
    last = ends.relief_end if trace.kind == "profile" else ends.last
    low, high = (place(trace.kind, end, gear) for end in (ends.first, last))
    half = 0.5 * gear.face_width
    rows = zip(places(trace, conventions, gear).tolist(), trace.values.tolist(), trace.lines, strict=True)
    for coordinate, value, line in rows:
        if not low - _ROUNDING_M <= coordinate <= high + _ROUNDING_M:
            account[OUTSIDE] += 1
            continue
        if value == conventions.undefined:
            account[UNMEASURED] += 1
            continue
        if abs(value) > LARGEST_UM:
            raise ValueError(f"a file of deviations up to {LARGEST_UM:g} µm; line {line} has {value:g}")
        # the datum face, from which the machine sees the gear, is the upper one
        roll, face = (coordinate, None) if trace.kind == "profile" else (None, half - coordinate)
        excess = MATERIAL[trace.flank] * value * UM
        yield Point(
            line, sheet_tooth(trace.tooth, conventions, gear), trace.flank, trace.kind, roll, face, excess
        )


def _pitch_points(table: PitchTable, conventions: Conventions, gear: Toothing) -> Iterator[Point]:
    sign = 1 if conventions.clockwise else -1
    for row, (line, value) in enumerate(zip(table.lines, table.values[:, 1], strict=True), 1):
        tooth = sheet_tooth(row, conventions, gear)
        yield Point(line, tooth, table.flank, "cumulative_pitch", None, None, sign * float(value) * UM)


def sheet_tooth(tooth: int, conventions: Conventions, gear: Toothing) -> int:
    """Return the number clockwise from tooth 1 of a tooth as the machine counts it."""
    return tooth if conventions.clockwise else (1 - tooth) % gear.teeth + 1


@dataclass
class _Reader:
    """Goes through the lines of a file once."""

    lines: list[str]
    gear: Toothing

    def file(self) -> MachineFile:
        self.heading = Heading()
        self.account: Counter[str] = Counter()
        traces: list[Trace] = []
        tables: list[PitchTable] = []
        printed: list[Printed] = []
        title, at, points = "", 0, 0
        while at < len(self.lines):
            line = self.lines[at].strip()
            at += 1
            if match := _TRACE.fullmatch(line):
                title = match["title"] or title
                trace, at = self._trace(match, title, at)
                traces.append(trace)
                points += trace.values.size
            elif match := _PITCHES.fullmatch(line):
                self.account[_OTHER] += 1
                table, at = self._table(_FLANKS[match["flank"]], at)
                tables.append(table)
                points += len(table.lines)
            elif (value := printed_value(line, at)) is not None:
                printed.append(value)
                self.account["printed value"] += 1
            else:
                title = self._title(self.lines[at - 1], at) or title
            if points > MAX_POINTS:
                raise ValueError(f"a file of at most {MAX_POINTS} points")
        if not traces and not tables:
            raise ValueError("a file with a profile, a helix or pitches; it has none")
        return MachineFile(
            self.heading.conventions(), tuple(traces), tuple(tables), tuple(printed), self.account
        )

    def _title(self, line: str, number: int) -> str:
        """Take a line that is neither trace nor pitch; return the title of traces in it, or ""."""
        if match := _BLOCK.fullmatch(line.strip()):
            self.account["heading"] += 1
            return match["title"]
        if not line.strip():
            self.account["comment or blank"] += 1
        elif (text := self.heading.take(line, number)) is not None:
            self._check_gear(text, number)
            self.account["heading"] += 1
        else:
            known = re.match(r"(Fuß|Kopf)kreisdurchmesser|Zahn-Nr|Z-Nr|[-+.\d\sLR]+$", line.strip())
            self.account[_OTHER if known else UNKNOWN] += 1
        return ""

    def _check_gear(self, text: str, number: int) -> None:
        """Refuse the file of another gear."""
        label, _, rest = text.partition(":")
        values = [float(value) for value in NUMBER.findall(rest)]
        if "hnezahl z" in label and values and values[0] != self.gear.teeth:
            raise ValueError(
                f"the file of a gear of {self.gear.teeth} teeth; line {number} has {values[0]:g}"
            )
        module = self.gear.normal_module / MM
        if "Normalmodul" in label and values and abs(values[0] / module - 1.0) > _MODULE_ERROR:
            raise ValueError(f"the file of a gear of module {module:g} mm; line {number} has {values[0]:g}")

    def _trace(self, match: re.Match[str], title: str, line: int) -> tuple[Trace, int]:
        """Return the trace below a line, and the line after it."""
        tooth, count, at = int(match["tooth"]), int(match["count"]), line
        if not 1 <= tooth <= self.gear.teeth:
            raise ValueError(f"a file of teeth from 1 to {self.gear.teeth}; line {line} has {tooth}")
        kind = None if match["tag"] else _KINDS.get(title)
        values: list[float] = []
        numbers: list[int] = []
        while len(values) < count and at < len(self.lines):
            texts = self.lines[at].split()
            at += 1
            if not all(NUMBER.fullmatch(text) for text in texts):
                raise ValueError(f"a file of {count} values in the trace of line {line}; line {at} is none")
            values += map(float, texts)
            numbers += [at] * len(texts)
        if len(values) != count or not count:
            raise ValueError(f"a file of {count} values in the trace of line {line}; there are {len(values)}")
        return Trace(line, kind, tooth, _FLANKS[match["flank"]], np.array(values), tuple(numbers)), at

    def _table(self, flank: Flank, at: int) -> tuple[PitchTable, int]:
        """Return the table of pitches below a line, and the line after it."""
        rows: list[list[float]] = []
        numbers: list[int] = []
        while at < len(self.lines):
            line = self.lines[at]
            if match := _ROW.fullmatch(line):
                values = [float(value) for value in match["values"].split()]
                if int(match["tooth"]) != len(rows) + 1 or max(map(abs, values)) > LARGEST_UM:
                    break
                rows.append(values)
                numbers.append(at + 1)
            elif line.strip() and (rows or not line.strip().startswith("Zahn-Nr")):
                break
            else:
                self.account["comment or blank" if not line.strip() else _OTHER] += 1
            at += 1
        if len(rows) != self.gear.teeth or (at < len(self.lines) and _ROW.fullmatch(self.lines[at])):
            line_number = min(at + 1, len(self.lines))
            raise ValueError(
                f"a file with the pitches of teeth 1 to {self.gear.teeth} in turn; line {line_number} is none"
            )
        return PitchTable(flank, tuple(numbers), np.array(rows)), at
