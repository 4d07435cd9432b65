"""The sheet of an inspection, whichever file it came in: points of traces, each once."""

from __future__ import annotations

from collections.abc import Iterable

from fe_contact.geometry import Toothing
from lineofaction.gearbox.inspection.machine_file import is_machine_file, machine_sheet
from lineofaction.gearbox.inspection.sheet import Point, Sheet, csv_sheet
from lineofaction.gearbox.problems import BadInput

FIELD = "measured"
REMEDY = "See docs/how-to/measured-gear.md."


def read_sheet(text: str, gear: Toothing, name: str) -> Sheet:
    """Return the points of a gear that the text of a CSV file or of a measuring machine holds.

    Raises `BadInput`: the first line that is none, by its number.
    """
    try:
        sheet = machine_sheet(text, gear) if is_machine_file(text) else csv_sheet(text, gear)
        _refuse_repeated(sheet.points)
    except ValueError as fault:
        raise BadInput.of(FIELD, name, str(fault), REMEDY) from None
    return sheet


def _refuse_repeated(points: Iterable[Point]) -> None:
    seen: dict[tuple[object, ...], int] = {}
    for point in points:
        key = (point.tooth, point.flank, point.trace, point.roll, point.face)
        if key in seen:
            raise ValueError(f"a file that gives each point once; line {point.line} repeats line {seen[key]}")
        seen[key] = point.line
