"""``loa export STE.nc --rexs UNIT.rexs -o OUT.rexs``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from service.cli.output import check_writable, console, print_json
from service.cli.ste import open_ste
from service.from_rexs.opened import opened
from service.problems import BadInput
from service.rexs import Attribute, Document, read_rexs, serialized
from service.to_rexs.calculated import CALCULATED
from service.to_rexs.exported import exported

_ONLY_TORQUE = ("normal_force_n", "misalignment_um", "center_distance_change_mm")


def run_export_rexs(
    file: Path, rexs: Path, output: Path, point: dict[str, float | None], *, as_json: bool
) -> None:
    """Read both files, add the table's results to the unit, write, print."""
    for name in _ONLY_TORQUE:
        if point[name] is not None:
            option = f"--{name.replace('_', '-')}"
            raise BadInput.of(option, point[name], "left out with --rexs", "Results are those of --torque.")
    check_writable(output)
    document = read_rexs(rexs)
    written = exported(document, opened(document).cases, [open_ste(file)], point["torque_n_m"])
    output.write_bytes(serialized(written, output.name))
    facts: dict[str, Any] = {"file": str(output), "calculated": _calculated(written)}
    if as_json:
        print_json(facts)
        return
    for number, names in facts["calculated"].items():
        console().print(f"component {number}: {', '.join(names)}", highlight=False)
    console().print(f"written to {output}", highlight=False)


def _calculated(document: Document) -> dict[str, list[str]]:
    """Return the calculated attributes by component."""
    return {
        str(component.id): names
        for component in document.model.components
        if (names := [entry.id for entry in component.attributes if _is_calculated(entry)])
    }


def _is_calculated(attribute: Attribute) -> bool:
    """Return whether an attribute is a result."""
    return attribute.origin == CALCULATED
