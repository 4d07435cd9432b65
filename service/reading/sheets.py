"""The sheet of an inspection, or a draw within a class, put into a case as routes answer it."""

from __future__ import annotations

from pathlib import Path

from lineofaction.gearbox.convert.case import case_as_filed
from lineofaction.gearbox.inspection.as_made import Inspected, drawn_case, measured_case
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated
from service.reading.texts import Announce, Json


def case_as_made(inputs: Json, _folder: Path, _announce: Announce) -> Json:
    """Return the case in ``{"inputs": {"case": ...}, ...}`` with gears as made; raises `BadInput`."""
    case, sheet = validated(Case, inputs["inputs"]["case"]), inputs["measured"]
    if sheet is None:
        drawn = drawn_case(case, inputs["tolerance_class"], inputs["seed"])
        return {"case": case_as_filed(drawn), "left_out": []}
    of = Inspected(sheet["gear"], sheet["loaded"], sheet["cutoff_mm"])
    made, measured = measured_case(case, sheet["csv"], "csv", of)
    return {"case": case_as_filed(made), "left_out": [*measured.differences, *measured.omitted]}
