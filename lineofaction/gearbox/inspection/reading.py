"""The sheet of an inspection, whichever file it came in: points of traces, each once."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from fe_contact.geometry import Toothing
from lineofaction.gearbox.inspection.machine_file import is_machine_file, machine_file, machine_sheet
from lineofaction.gearbox.inspection.machine_judgement import judgement_of
from lineofaction.gearbox.inspection.machine_values import identity, value_file
from lineofaction.gearbox.inspection.sheet import Point, Sheet, csv_sheet
from lineofaction.gearbox.problems import BadInput

FIELD = "measured"
REMEDY = "See docs/how-to/measured-gear.md."


def read_sheet(text: str, gear: Toothing, name: str, values: str | None = None) -> Sheet:
    """Return the points of a gear that the text of a CSV file or of a measuring machine holds.

    `values` is the text of the value file of the same gear, whose results judge the reading.
    Raises `BadInput`: the first line that is none, by its number.
    """
    try:
        sheet = _machine_sheet(text, gear, values) if is_machine_file(text) else csv_sheet(text, gear)
        _refuse_repeated(sheet.points)
    except ValueError as fault:
        raise BadInput.of(FIELD, name, str(fault), REMEDY) from None
    return sheet


def _machine_sheet(text: str, gear: Toothing, values: str | None) -> Sheet:
    file = machine_file(text, gear)
    results = None if values is None else value_file(values)
    if results is not None and results.identity != identity(text.splitlines()):
        raise ValueError("a curve file whose value file is of the same gear; date, time or number differ")
    sheet = machine_sheet(file, gear)
    judgement = judgement_of(file, gear, () if results is None else results.printed)
    return replace(sheet, recomputed=judgement.recomputed, differences=judgement.differences)


def _refuse_repeated(points: Iterable[Point]) -> None:
    seen: dict[tuple[object, ...], int] = {}
    for point in points:
        key = (point.tooth, point.flank, point.trace, point.roll, point.face)
        if key in seen:
            raise ValueError(f"a file that gives each point once; line {point.line} repeats line {seen[key]}")
        seen[key] = point.line
