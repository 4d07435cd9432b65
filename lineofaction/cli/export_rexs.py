"""``loa export STE.nc | DEFLECTION.nc --rexs UNIT.rexs -o OUT.rexs``."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from lineofaction.cli.output import check_writable, console, print_json
from lineofaction.cli.ste import open_ste
from lineofaction.cli.warned import warn
from lineofaction.gearbox.from_rexs.opened import opened
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import Study
from lineofaction.gearbox.rexs import Attribute, Document, read_rexs, serialized
from lineofaction.gearbox.schemas.warning import left_out_warnings
from lineofaction.gearbox.to_rexs.calculated import CALCULATED
from lineofaction.gearbox.to_rexs.deflected import deflected, left_out
from lineofaction.gearbox.to_rexs.exported import exported
from lineofaction.report.document.inputs import file_attributes
from lineofaction.report.document.stored_study import read_stored, stored_study

_ONLY_TORQUE = ("normal_force_n", "misalignment_um", "center_distance_change_mm")


def run_export_rexs(
    file: Path, rexs: Path, output: Path, point: dict[str, float | None], *, as_json: bool
) -> None:
    """Read both files, add the results of a table or a deflection to the unit, write, print."""
    check_writable(output)
    document = read_rexs(rexs)
    unit = opened(document)
    warn(left_out_warnings(unit.left_out))
    facts: dict[str, Any] = {"file": str(output)}
    study = _study(file)
    if study is not None and study.name == "deflect":
        _refuse_point(point, tuple(point))
        result = read_stored(study, file)
        written = deflected(document, unit, result)
        facts["left_out"] = left_out(unit, result)
    else:
        _refuse_point(point, _ONLY_TORQUE)
        written = exported(document, unit.cases, [open_ste(file)], point["torque_n_m"])
    output.write_bytes(serialized(written, output.name))
    facts["calculated"] = _calculated(written)
    if as_json:
        print_json(facts)
        return
    for line in _lines(facts["calculated"]):
        console().print(line, highlight=False, soft_wrap=True)
    if facts.get("left_out"):
        console().print(
            f"left out, no component of their own: {', '.join(facts['left_out'])}", highlight=False
        )
    console().print(f"written to {output}", highlight=False)


def _lines(calculated: dict[str, list[str]]) -> list[str]:
    """Return a line for components with the same results."""
    alike: dict[tuple[str, ...], list[str]] = {}
    for number, names in calculated.items():
        alike.setdefault(tuple(names), []).append(number)
    return [
        f"component{'s' * (len(numbers) > 1)} {', '.join(numbers)}: {', '.join(names)}"
        for names, numbers in alike.items()
    ]


def _study(file: Path) -> Study | None:
    """Return the study whose result a file holds, None of another file."""
    readable = file.is_file() and file.suffix not in (".toml", ".json")
    return stored_study(file_attributes(file)) if readable else None


def _refuse_point(point: dict[str, float | None], names: Iterable[str]) -> None:
    """Refuse the options of a load point that the results do not depend on."""
    for name in names:
        if point[name] is not None:
            option = f"--{name.replace('_', '-')}"
            bound = "Results are those of --torque, of a deflection those of its load cases."
            raise BadInput.of(option, point[name], "left out with --rexs", bound)


def _calculated(document: Document) -> dict[str, list[str]]:
    """Return the names of the calculated attributes by component, those in load cases too."""
    names: dict[str, dict[str, None]] = {}
    for _, component in document.model.all_components():
        for entry in component.attributes:
            if _is_calculated(entry):
                names.setdefault(str(component.id), {})[entry.id] = None
    return {number: list(found) for number, found in names.items()}


def _is_calculated(attribute: Attribute) -> bool:
    return attribute.origin == CALCULATED
