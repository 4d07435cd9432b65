"""``loa measured``: the deviations of a gear from the sheet of its inspection, and a sheet from a case."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from bounds import engineering
from bounds.types import Json
from lineofaction.cli.measured_folder import run_folder
from lineofaction.cli.output import check_writable, console, print_json, print_written, table
from lineofaction.cli.verb_warnings import STRICT, warn
from lineofaction.gearbox.convert.case import case_json
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.inspection.as_made import Inspected, measured_case
from lineofaction.gearbox.inspection.evaluation import Split
from lineofaction.gearbox.inspection.machine_judgement import LIMIT_UM
from lineofaction.gearbox.inspection.measured_gear import MeasuredGear, inspected
from lineofaction.gearbox.inspection.population import values_beside
from lineofaction.gearbox.inspection.reading import FIELD
from lineofaction.gearbox.inspection.sheet import Flank, sheet_text
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.schemas.named_files import read_text
from lineofaction.gearbox.schemas.plan import omission_warnings
from lineofaction.gearbox.schemas.toml import toml_text
from lineofaction.gearbox.units import MM, UM


def run_measured(
    file: InputFile,
    sheet: Path | None,
    mounted: tuple[str, Flank, float | None, bool],
    output: Path | None,
    *,
    as_json: bool,
) -> None:
    """Write the case with the measured deviations; without a sheet, write the sheet that the case would give.

    Of a folder of sheets the population is written.
    `mounted`: the fields of `Inspected`.
    """
    case, inspected_gear = read_model(Case, file), Inspected(*mounted)
    if output is not None:
        check_writable(output)
    if sheet is None:
        _write(output, sheet_text(inspected(inspected_gear.chart(case))))
        return
    if sheet.is_dir():
        run_folder(case, sheet, inspected_gear, output, as_json=as_json)
        return
    try:
        text, values = read_text(sheet, str(sheet)), values_beside(sheet)
    except BadInput as error:
        raise error.within(FIELD) from None
    changed, gear = measured_case(case, text, str(sheet), inspected_gear, values)
    warn(machine_warnings(gear.differences))
    warn(omission_warnings(gear.omitted, "case"))
    written = [] if output is None or (gear.differences and STRICT.get()) else [output]
    for path in written:
        path.write_text(toml_text(case_json(changed)), encoding="utf-8")
    if as_json:
        print_json(_as_json(gear, written))
        return
    _show(gear)
    print_written(written)


def machine_warnings(differences: Iterable[str]) -> list[Json]:
    """Return the values that a machine printed otherwise than they are recomputed as warnings."""
    nothing = {
        "field": FIELD,
        "value": None,
        "unit": "",
        "low": None,
        "high": None,
        "reason": "",
        "source": "",
    }
    return [{"check": "machine_value", **nothing, "whole": "", "message": text} for text in differences]


def _write(output: Path | None, text: str) -> None:
    if output is None:
        console().print(text, end="", soft_wrap=True, markup=False, highlight=False)
    else:
        output.write_text(text, encoding="utf-8")
        print_written([output])


def _show(gear: MeasuredGear) -> None:
    out = console()
    if gear.recomputed:
        equal = gear.recomputed - sum("recomputed" in text for text in gear.differences)
        out.print(
            f"Values printed by the machine: {equal} of {gear.recomputed} recomputed within {LIMIT_UM:g} µm."
        )
    if gear.splits:
        head = ("tooth", "trace", "f_H, µm", "f_f, µm", "over, mm", "cut-off, mm")
        rows = [
            (str(tooth), trace, *_figures(split)) for (tooth, trace), split in sorted(gear.splits.items())
        ]
        title = "Slope and form" if gear.ranged else "Slope and form, Gaussian filter (ISO 16610-21)"
        out.print(table(head, rows, title, ("trace",)))
    lines = [(fate, str(count)) for fate, count in gear.account.items() if count]
    out.print(table(("lines", "number"), lines, "Every line of the sheet", ("lines",)))


def _figures(split: Split) -> tuple[str, ...]:
    values = (
        split.slope / UM,
        split.form / UM,
        split.length / MM,
        split.cutoff / MM,
    )
    return tuple(engineering(float(value), 3) for value in values)


def _as_json(gear: MeasuredGear, written: list[Path]) -> Json:
    traces = [
        {
            "tooth": tooth,
            "trace": trace,
            "slope_um": split.slope / UM,
            "form_um": split.form / UM,
            "length_mm": split.length / MM,
            "cutoff_mm": split.cutoff / MM,
        }
        for (tooth, trace), split in sorted(gear.splits.items())
    ]
    files = [str(path) for path in written]
    machine = {"recomputed": gear.recomputed, "differences": list(gear.differences)}
    return {
        "machine": machine,
        "lines": dict(gear.account),
        "traces": traces,
        "fields": dict(gear.fields),
        "written": files,
    }
