"""Files of every kind by one function: cases, scenes, gear units, tables, runs, results of studies."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.workbench import open_unit
from lineofaction.gearbox.workbench import read as read_input

UNITS = (".rexs", ".rexsj", ".rexsz", ".rexs.zip")
"""Endings of gear units."""


def read(file: Path | str, overrides: Mapping[str, object] | None = None) -> Any:
    """Read a file that `loa` takes or writes.

    Raises `BadInput`: the file is missing, damaged or of another kind.

    Parameters
    ----------
    file : path
        Case or scene (TOML or JSON; what has shafts is a scene), gear unit (REXS), or a result (netCDF).
    overrides : mapping of str to object, optional
        Values over those of a case or a scene by their paths, as ``{"loads.brake.torque_n_m": 40}``.

    Returns
    -------
    Case, SceneInput, OpenedUnit, SteDatabase, RunResult or the result of a study
    """
    path = Path(file)
    is_result = path.suffix == ".nc"
    if overrides and (is_result or path.name.lower().endswith(UNITS)):
        remedy = "Leave them out; loa.open_unit takes those of the scene of a unit."
        raise BadInput.of("overrides", ", ".join(overrides), "those of a case or a scene", remedy)
    if is_result:
        from lineofaction.report.document import read_file  # noqa: PLC0415 (start-up time: it draws)

        return read_file(path)
    return open_unit(path) if path.name.lower().endswith(UNITS) else read_input(path, overrides)
