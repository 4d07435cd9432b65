"""Traces of an inspection as CSV: reader and writer; every line is a point, a comment or refused."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from fe_contact.geometry import Toothing
from lineofaction.gearbox.schemas.csv_rows import Cells, csv_rows, number_in
from lineofaction.gearbox.units import DEGREE, MM, UM

Flank = Literal["left", "right"]
OMITTED = "left out: "
PITCHES = ("pitch", "cumulative_pitch")
TRACES = (*PITCHES, "profile", "helix", "topography")
PROFILE = ("roll_length_mm", "roll_angle_deg", "diameter_mm")
FACE = ("face_position_mm", "face_distance_mm")
_TOOTH = re.compile(r"[0-9]{1,4}")
LARGEST_UM = 1000.0
"""Largest deviation, um; a larger one is in another unit."""
MAX_POINTS = 200_000


@dataclass(frozen=True)
class Point:
    """A point of a trace in SI; `roll` and `face` are None where the trace has no such place."""

    line: int
    """Number of the line in the file, from 1."""
    tooth: int
    """Number of the tooth, from 1, clockwise as seen on the datum face."""
    flank: Flank
    trace: str
    roll: float | None
    face: float | None
    """`roll`, `face`: Roll length, and distance from mid-face, m."""
    deviation: float
    """Deviation, m: > 0 in excess for profile, helix and topography; > 0 clockwise for pitches."""


@dataclass(frozen=True)
class Interval:
    """Evaluated part of a trace: roll lengths, or distances from mid-face, m."""

    first: float
    last: float
    length: float
    """Length over which the rise of the mean line is the slope."""


@dataclass(frozen=True)
class Sheet:
    """Points of a file, and the numbers of its other lines or points by what they were taken for."""

    points: tuple[Point, ...]
    account: Mapping[str, int]
    intervals: Mapping[tuple[str, Flank], Interval] = field(default_factory=dict)
    """Evaluated part of profiles and helices of a flank, where the file states it."""
    recomputed: int = 0
    """Number of values that the machine printed and that are recomputed."""
    differences: tuple[str, ...] = ()
    """Values that the machine printed otherwise than they are recomputed."""


def csv_sheet(text: str, gear: Toothing) -> Sheet:
    """Return the points that the text of a CSV file holds, of a gear.

    Raises `ValueError`: the first line that is none, by its number.
    """
    file = csv_rows(text, MAX_POINTS)
    _check_heading(file.heading)
    points = tuple(_point(number, row, gear) for number, row in file.rows())
    if not points:
        raise ValueError("a file with a row per point; it has a heading alone")
    return Sheet(points, {"heading": 1, "comment or blank": file.silent})


def sheet_text(points: Iterable[Point]) -> str:
    """Return points as the text of a CSV file."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("tooth", "flank", "trace", PROFILE[0], FACE[0], "deviation_um"))
    for point in points:
        coordinates = (_written(point.roll, MM), _written(point.face, MM))
        deviation = _written(point.deviation, UM)
        writer.writerow((point.tooth, point.flank, point.trace, *coordinates, deviation))
    return text.getvalue()


def _written(value: float | None, unit: float) -> str:
    return "" if value is None else f"{value / unit + 0.0:.9g}"


def _check_heading(heading: list[str]) -> None:
    known = ("tooth", "flank", "trace", "deviation_um", *PROFILE, *FACE)
    if len(set(heading)) != len(heading) or not set(heading) <= set(known):
        raise ValueError(
            f"a file whose heading names each column once, of {', '.join(known)}; it is {heading}"
        )
    for needed in ("tooth", "flank", "trace", "deviation_um"):
        if needed not in heading:
            raise ValueError(f"a file with the column {needed}; its heading is {heading}")
    for several in (PROFILE, FACE):
        if len(set(several) & set(heading)) > 1:
            raise ValueError(f"a file with one of the columns {', '.join(several)}; its heading is {heading}")


def _point(line: int, row: Cells, gear: Toothing) -> Point:
    tooth, flank, trace = row["tooth"], row["flank"], row["trace"]
    if not _TOOTH.fullmatch(tooth) or not 1 <= int(tooth) <= gear.teeth:
        raise ValueError(f"a file of teeth from 1 to {gear.teeth}; line {line} has {tooth!r}")
    if flank not in ("left", "right"):
        raise ValueError(f"a file of left and right flanks; line {line} has {flank!r}")
    if trace not in TRACES:
        raise ValueError(f"a file of the traces {', '.join(TRACES)}; line {line} has {trace!r}")
    roll = _roll(row, gear, line) if trace in ("profile", "topography") else None
    face = _face(row, gear, line) if trace in ("helix", "topography") else None
    deviation = number_in(row, "deviation_um", line)
    if abs(deviation) > LARGEST_UM:
        raise ValueError(f"a file of deviations up to {LARGEST_UM:g} µm; line {line} has {deviation:g}")
    side: Flank = "left" if flank == "left" else "right"
    return Point(line, int(tooth), side, trace, roll, face, deviation * UM)


def _roll(row: Cells, gear: Toothing, line: int) -> float:
    column = next((name for name in PROFILE if name in row), None)
    if column is None:
        raise ValueError(
            f"a file with one of the columns {', '.join(PROFILE)}: line {line} is along the profile"
        )
    value = number_in(row, column, line)
    if column == "roll_length_mm":
        return value * MM
    if column == "roll_angle_deg":
        return value * DEGREE * gear.base_radius
    radius = 0.5 * value * MM
    if radius < gear.base_radius or not math.isfinite(radius**2):
        raise ValueError(
            f"a file of diameters from {2e3 * gear.base_radius:.6g} mm on; line {line} has {value:g}"
        )
    return math.sqrt(radius**2 - gear.base_radius**2)


def _face(row: Cells, gear: Toothing, line: int) -> float:
    column = next((name for name in FACE if name in row), None)
    if column is None:
        raise ValueError(f"a file with one of the columns {', '.join(FACE)}: line {line} is along the face")
    value = number_in(row, column, line) * MM
    return value if column == "face_position_mm" else value - 0.5 * gear.face_width
