"""Cases of files, assessed before anything is computed."""

from __future__ import annotations

from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.convert.case import case_at
from lineofaction.gearbox.convert.case_plausibility import case_warnings
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.schemas.fault_lines import located
from lineofaction.gearbox.schemas.flank_point import FlankPoint


def assessed_case(file: InputFile, point: FlankPoint | None = None) -> CheckedCase:
    """Return the case in a file, at one load and alignment if requested; warn of implausible values.

    Raises `BadInput`: the file holds no case, or no such pair exists.
    """
    case = read_model(Case, file)
    if point is not None:
        case = case_at(case, point)
    checked = CheckedCase(case)
    with located(file):
        warn(case_warnings(checked))
    return checked
