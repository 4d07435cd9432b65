"""``loa open``: cases, scene, load cases and account of a REXS file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from lineofaction.cli.output import console, print_json, print_written
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.from_rexs.account import FATES
from lineofaction.gearbox.from_rexs.assumptions import Assumption
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import read_rexs
from lineofaction.gearbox.schemas.plan import omission_warnings


def run_open(file: Path, output: Path | None, assume: Sequence[str] = (), *, as_json: bool) -> None:
    """Open a REXS file: write cases, scene, load cases and account, and print deviations from the file.

    What is left out of the scene comes first and last.
    """
    unit = OpenedUnit.of(read_rexs(file), [Assumption.of(text) for text in assume])
    folder = output or Path(file.name).with_suffix("")
    written = _write_unit(unit, folder)
    counts = Counter[str](line.fate for line in unit.lines)
    headline = unit.headline
    if headline and not as_json:
        console().print(headline, soft_wrap=True)
    warn(omission_warnings(unit.omitted))
    if as_json:
        print_json(
            {
                "written": [str(path) for path in written],
                "cases": [case.name for case in unit.cases],
                "scene": unit.scene is not None,
                "load_cases": [case.table() for case in unit.load_cases],
                "account": {fate: counts[fate] for fate in FATES},
                "lines": list(unit.summary()),
            }
        )
        return
    _show_unit(unit, counts, written)
    if headline:
        console().print(headline, soft_wrap=True)


def _write_unit(unit: OpenedUnit, folder: Path) -> list[Path]:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInput.of("output", str(folder), f"a folder that can be made ({error.strerror})") from None
    written = []
    for name, text in unit.files().items():
        path = folder / name
        path.write_text(text, encoding="utf-8")
        written.append(path)
    return written


def _show_unit(unit: OpenedUnit, counts: Counter[str], written: list[Path]) -> None:
    out = console()
    values = ", ".join(f"{counts[fate]} {fate}" for fate in FATES if counts[fate])
    out.print(f"{len(unit.lines)} components and values: {values}", soft_wrap=True)
    for line in unit.summary(("assumed", "defaulted", "derived")):
        out.print(line, soft_wrap=True)
    for case in unit.cases:
        others = f" (and {len(case.equal)} equal)" if case.equal else ""
        gears = f"gears {case.driver} and {case.driven}, {case.center_distance * 1e3:.6g} mm"
        out.print(f"stage {case.stage}{others}: {case.name}.toml, {gears}")
    for load in unit.load_cases:
        point = f"{load.torque_n_m:g} N m at {load.speed_rpm:g} rpm, {load.direction}, share {load.share:g}"
        others = "".join(
            f", {force['name']} {force['force_n']} N and {force['moment_n_m']} N m in x, y, z"
            for force in load.forces
        )
        out.print(f"{load.name}: {point}{others}", soft_wrap=True)
    print_written(written)
