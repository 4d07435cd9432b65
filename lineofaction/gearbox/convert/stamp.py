"""Warnings in the files of results: an attribute of netCDF files, a member of the JSON that verbs write."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5netcdf

from model_studies.netcdf import opened_netcdf

Json = dict[str, Any]
WARNINGS = "warnings"


def stamp(file: Path, warnings: Sequence[Json]) -> None:
    """Write warnings into a file that this program has just made; other kinds of files stay as they are."""
    if file.suffix == ".nc":
        with h5netcdf.File(file, "r+") as content:
            content.attrs[WARNINGS] = json.dumps(list(warnings))
    elif file.suffix == ".json":
        text = json.dumps(json.loads(file.read_text(encoding="utf-8")) | {WARNINGS: list(warnings)})
        file.write_text(f"{text}\n", encoding="utf-8")


def stamped(file: Path) -> list[Json]:
    """Return the warnings of the netCDF file of a result; none of an older one."""
    with opened_netcdf(file) as content:
        return list(json.loads(content.attrs.get(WARNINGS, "[]")))
