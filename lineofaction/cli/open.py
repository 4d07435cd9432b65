"""``loa open``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from lineofaction.cli.output import console, print_json
from lineofaction.cli.warned import warn
from lineofaction.gearbox.from_rexs.account import FATES
from lineofaction.gearbox.from_rexs.assumption import Assumption
from lineofaction.gearbox.from_rexs.files import report_lines, unit_files
from lineofaction.gearbox.from_rexs.left_out import headline
from lineofaction.gearbox.from_rexs.load_case import LoadCase
from lineofaction.gearbox.from_rexs.opened import OpenedUnit, opened
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs import read_rexs
from lineofaction.gearbox.schemas.warning import left_out_warnings


def run_open(file: Path, out: Path | None, assume: Sequence[str] = (), *, as_json: bool) -> None:
    """Open a REXS file: write cases, scene, load cases and account, and print what is not taken as it is.

    What is left out of the scene comes first and last.
    """
    unit = opened(read_rexs(file), [Assumption.of(text) for text in assume])
    folder = out or Path(file.name).with_suffix("")
    written = _write(unit, folder)
    counts = Counter[str](line.fate for line in unit.lines)
    left_out = headline(unit.lines)
    if left_out and not as_json:
        console().print(left_out, highlight=False, soft_wrap=True)
    warn(left_out_warnings(unit.left_out))
    if as_json:
        print_json(
            {
                "written": [str(path) for path in written],
                "cases": [case.name for case in unit.cases],
                "scene": unit.scene is not None,
                "load_cases": [case.table() for case in unit.load_cases],
                "account": {fate: counts[fate] for fate in FATES},
                "lines": list(report_lines(unit.lines)),
            }
        )
        return
    _show(unit, counts, written)
    if left_out:
        console().print(left_out, highlight=False, soft_wrap=True)


def _others(load: LoadCase) -> str:
    """Return the forces that are not as in the scene."""
    return "".join(
        f", {force['name']} {force['force_n']} N and {force['moment_n_m']} N m in x, y, z"
        for force in load.forces
    )


def _write(unit: OpenedUnit, folder: Path) -> list[Path]:
    """Write the files into a folder, which is made."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInput.of("out", str(folder), f"a folder that can be made ({error.strerror})") from None
    written = []
    for name, text in unit_files(unit).items():
        path = folder / name
        path.write_text(text, encoding="utf-8")
        written.append(path)
    return written


def _show(unit: OpenedUnit, counts: Counter[str], written: list[Path]) -> None:
    """Print the report for people."""
    out = console()
    values = ", ".join(f"{counts[fate]} {fate}" for fate in FATES if counts[fate])
    out.print(f"{len(unit.lines)} components and values: {values}", highlight=False, soft_wrap=True)
    for line in report_lines(unit.lines, ("assumed", "defaulted", "derived")):
        out.print(line, highlight=False, soft_wrap=True)
    for case in unit.cases:
        others = f" (and {len(case.equal)} equal)" if case.equal else ""
        gears = f"gears {case.driver} and {case.driven}, {case.center_distance * 1e3:.6g} mm"
        out.print(f"stage {case.stage}{others}: {case.name}.toml, {gears}", highlight=False)
    for load in unit.load_cases:
        words = f"{load.torque_n_m:g} N m at {load.speed_rpm:g} rpm, {load.direction}, share {load.share:g}"
        out.print(f"{load.name}: {words}{_others(load)}", highlight=False, soft_wrap=True)
    out.print(f"written to {', '.join(map(str, written))}", highlight=False, soft_wrap=True)
