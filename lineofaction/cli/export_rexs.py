"""``loa export STE.nc | DEFLECTION.nc --rexs UNIT.rexs -o OUT.rexs``: results in REXS."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from lineofaction.cli.export_point import Point
from lineofaction.cli.output import check_writable, console, print_json, print_written
from lineofaction.cli.ste import open_ste
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import read_rexs, serialized
from lineofaction.gearbox.rexs.model import Document
from lineofaction.gearbox.schemas.plan import omission_warnings
from lineofaction.gearbox.to_rexs.attributes import CALCULATED
from lineofaction.gearbox.to_rexs.deflection import deflected, omissions
from lineofaction.gearbox.to_rexs.stage import exported
from lineofaction.report.document import file_attributes, read_stored, stored_study

_ONLY_TORQUE = ("normal_force_n", "misalignment_um", "center_distance_change_mm")


def export_rexs(file: Path, rexs: Path, output: Path, point: Point, *, as_json: bool) -> None:
    """Add the results of a table or a deflection to the unit."""
    check_writable(output)
    document = read_rexs(rexs)
    unit = OpenedUnit.of(document)
    warn(omission_warnings(unit.omitted))
    answer: dict[str, Any] = {"file": str(output)}
    readable = file.is_file() and file.suffix not in (".toml", ".json")
    study = stored_study(file_attributes(file)) if readable else None
    if study is not None and study.name == "deflect":
        _refuse_point(point, tuple(point))
        result = read_stored(study, file)
        written = deflected(document, unit, result)
        answer["left_out"] = omissions(unit, result)
    else:
        _refuse_point(point, _ONLY_TORQUE)
        written = exported(document, unit.cases, [open_ste(file)], point["torque_n_m"])
    output.write_bytes(serialized(written, output.name))
    answer["calculated"] = _calculated(written)
    if as_json:
        print_json(answer)
        return
    for line in _lines(answer["calculated"]):
        console().print(line, soft_wrap=True)
    if answer.get("left_out"):
        console().print(f"left out, no component of their own: {', '.join(answer['left_out'])}")
    print_written([output])


def _lines(calculated: dict[str, list[str]]) -> list[str]:
    """Return a line for components with the same results."""
    alike: dict[tuple[str, ...], list[str]] = {}
    for number, names in calculated.items():
        alike.setdefault(tuple(names), []).append(number)
    return [
        f"component{'s' * (len(numbers) > 1)} {', '.join(numbers)}: {', '.join(names)}"
        for names, numbers in alike.items()
    ]


def _refuse_point(point: Point, names: Iterable[str]) -> None:
    """Refuse the options of a load point that the results do not depend on."""
    for name in names:
        if point[name] is not None:
            option = f"--{name.replace('_', '-')}"
            bound = "Results are those of --torque, of a deflection those of its load cases."
            raise BadInput.of(option, point[name], "left out with --rexs", bound)


def _calculated(document: Document) -> dict[str, list[str]]:
    names: dict[str, dict[str, None]] = {}
    for _, component in document.model.all_components():
        for entry in component.attributes:
            if entry.origin == CALCULATED:
                names.setdefault(str(component.id), {})[entry.id] = None
    return {number: list(ids) for number, ids in names.items()}
