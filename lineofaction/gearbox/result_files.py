"""Facts that the files of results carry with them: warnings, and the case behind the result."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5netcdf

from bounds.types import Json
from lineofaction.gearbox.studies.bodies import UNIT
from model_studies.netcdf import opened, opened_netcdf

LEDGER, WARNINGS, COMPLAINT = "effect_ledger", "warnings", "complaint"


def stamp(file: Path, warnings: Sequence[Json]) -> None:
    """Write warnings into a file that this program has just made; other kinds of files stay as they are."""
    if file.suffix == ".nc":
        with h5netcdf.File(file, "r+") as content:
            content.attrs[WARNINGS] = json.dumps(list(warnings))
    elif file.suffix == ".json":
        text = json.dumps(json.loads(file.read_text(encoding="utf-8")) | {WARNINGS: list(warnings)})
        file.write_text(f"{text}\n", encoding="utf-8")


def stamp_scene(file: Path, metadata: Json) -> None:
    """Write the complaint and the unit of a scene, from its metadata, into the file of a result."""
    with h5netcdf.File(file, "r+") as content:
        for name in (COMPLAINT, UNIT):
            if name in metadata:
                content.attrs[name] = json.dumps(metadata[name])


def stamped(file: Path) -> list[Json]:
    """Return the warnings of the netCDF file of a result; none of an older one."""
    with opened_netcdf(file) as content:
        return list(json.loads(content.attrs.get(WARNINGS, "[]")))


def case_of_file(file: Path) -> dict[str, Any] | None:
    """Return the case with all defaults, None if the file is none that can be read."""
    try:
        with opened(file) as content:
            case = json.loads(content.attrs["case"])
    except (KeyError, TypeError, ValueError):
        return None
    return case if isinstance(case, dict) else None
