"""``loa geometry``."""

from __future__ import annotations

from pathlib import Path

from fe_contact.geometry import ParallelAxes
from lineofaction.cli.assessed_case import assessed_case
from lineofaction.cli.output import check_writable, console, print_json, table
from lineofaction.cli.warned import messages, warn
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.topology import facts_of
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import UM
from lineofaction.report.document.write import write_whole
from lineofaction.report.drawing.figure import number
from lineofaction.report.drawing.image import png, svg
from lineofaction.report.drawing.page import Page
from lineofaction.report.tables.data_sheet import data_sheet, data_sheet_json, data_sheet_section
from lineofaction.report.tables.pair import pair_lead, pair_title
from lineofaction.report.tables.pair_drawing import pair_drawing
from lineofaction.report.tables.pair_remarks import pair_remarks

_ENDINGS = (".html", ".png", ".svg")
_WORDS = ("quantity", "symbol", "unit", "point")


def run_geometry(file: InputFile, output: Path | None, *, as_json: bool) -> None:
    """Print the data sheet of a case; draw it if requested."""
    pair = gear_pair(assessed_case(file))
    implausible = messages()
    warn(pair_remarks(pair))
    if output is not None:
        _write(pair, output, implausible)
    if as_json:
        written = {} if output is None else {"written": str(output)}
        print_json(written | data_sheet_json(pair))
    else:
        _show(pair, output)


def _write(pair: ParallelAxes, output: Path, implausible: list[str]) -> None:
    """Write the page, or the drawing alone."""
    if output.suffix not in _ENDINGS:
        raise BadInput.of("output", str(output), f"a file ending in one of {', '.join(_ENDINGS)}")
    check_writable(output)
    if output.suffix == ".html":
        facts = facts_of(pair)
        page = Page(pair_title(facts), pair_lead(facts), (), (data_sheet_section(pair),))
        write_whole(page, output, warnings=implausible)
    else:
        output.write_bytes({".png": png, ".svg": svg}[output.suffix](pair_drawing(pair)))


def _show(pair: ParallelAxes, output: Path | None) -> None:
    """Print the data sheet for people."""
    out = console()
    for part in data_sheet(pair):
        out.print(table(part.head, part.rows, part.caption, words=_WORDS))
        out.print()
    for line in _summary(pair):
        out.print(line, highlight=False)
    if output is not None:
        out.print(f"written to {output}", highlight=False)


def _summary(pair: ParallelAxes) -> tuple[str, str]:
    """Say what decides about noise and strength first."""
    facts = facts_of(pair)
    transverse, overlap = pair.active_contact_ratio, pair.overlap_ratio
    ratios = f"contact ratio {transverse:.3f} + {overlap:.3f} = {transverse + overlap:.3f}"
    backlash = f"circumferential backlash {number(pair.circumferential_backlash / UM, 3)} um"
    return f"{pair_title(facts)}: {pair_lead(facts)}", f"{ratios}; {backlash}"
