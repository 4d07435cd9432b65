"""``loa geometry``: the data sheet of a gear pair."""

from __future__ import annotations

from pathlib import Path

from fe_contact.geometry import ParallelAxes
from fe_contact.ste import PairGeometry
from lineofaction.cli.assessed_case import assessed_case
from lineofaction.cli.output import EMPHASIS, check_writable, console, print_json, table
from lineofaction.cli.verb_warnings import messages, warn
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import UM
from lineofaction.report.document import write_page
from lineofaction.report.drawing.figure import number
from lineofaction.report.drawing.image import png, svg
from lineofaction.report.drawing.page import Page
from lineofaction.report.pair import (
    data_sheet,
    data_sheet_json,
    data_sheet_section,
    pair_drawing,
    pair_lead,
    pair_remarks,
    pair_title,
)

_ENDINGS = (".html", ".png", ".svg")
_TEXT_COLUMNS = ("quantity", "symbol", "unit", "point")


def run_geometry(file: InputFile, output: Path | None, *, as_json: bool) -> None:
    """Print the data sheet of a case; draw it if requested."""
    checked = assessed_case(file)
    pair = checked.pair
    implausible = messages()  # for the page, which has the remarks on the pair already
    warn(pair_remarks(pair))
    if output is not None:
        _write_sheet(pair, checked.case.errors.misalignment_class, output, implausible)
    if as_json:
        written = {} if output is None else {"written": str(output)}
        print_json(written | data_sheet_json(pair))
    else:
        _show_sheet(pair, output)


def _write_sheet(
    pair: ParallelAxes, tolerance_class: int | None, output: Path, implausible: list[str]
) -> None:
    if output.suffix not in _ENDINGS:
        raise BadInput.of("output", str(output), f"a file ending in one of {', '.join(_ENDINGS)}")
    check_writable(output)
    if output.suffix == ".html":
        geometry = PairGeometry.of(pair)
        page = Page(
            pair_title(geometry), pair_lead(geometry), (), (data_sheet_section(pair, tolerance_class),)
        )
        write_page(page, output, warnings=implausible)
    else:
        output.write_bytes({".png": png, ".svg": svg}[output.suffix](pair_drawing(pair, tolerance_class)))


def _show_sheet(pair: ParallelAxes, output: Path | None) -> None:
    out = console()
    title, ratios = _summary(pair)
    out.print(title, soft_wrap=True, style=EMPHASIS)
    out.print(ratios, soft_wrap=True)
    for part in data_sheet(pair):
        out.print()
        out.print(table(part.head, part.rows, part.caption, text_columns=_TEXT_COLUMNS))
    if output is not None:
        out.print(f"written to {output}", soft_wrap=True)


def _summary(pair: ParallelAxes) -> tuple[str, str]:
    geometry = PairGeometry.of(pair)
    transverse, overlap = pair.active_contact_ratio, pair.overlap_ratio
    ratios = f"contact ratio {transverse:.3f} + {overlap:.3f} = {transverse + overlap:.3f}"
    backlash = f"circumferential backlash {number(pair.circumferential_backlash / UM, 3)} µm"
    return f"{pair_title(geometry)}: {pair_lead(geometry)}", f"{ratios}; {backlash}"
