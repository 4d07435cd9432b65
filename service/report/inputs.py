"""What a report is made from: an STE database, a run, or both; the files say which they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5netcdf

from dynamics.errors import DynamicsError
from dynamics.results import RunResult
from fe_contact.errors import FeContactError
from fe_contact.ste import SteDatabase
from service.problems import BadInput

_KINDS = {
    ("format", "lineofaction STE database"): "database",
    ("schema", "lineofaction dynamics run"): "run",
}
_BOUND = "an STE database or a run"


@dataclass(frozen=True)
class Inputs:
    """What was read; at least one of both."""

    database: SteDatabase | None = None
    run: RunResult | None = None


def read_inputs(files: Sequence[Path]) -> Inputs:
    """Read every file as what it says it is.

    Raises
    ------
    BadInput
        A file is neither, is damaged, there are two of a kind, or there is none at all.
    """
    if not files:
        raise BadInput.of("file", None, _BOUND, "Name at least one file.")
    read: dict[str, Any] = {}
    for file in files:
        kind = file_kind(file)
        if kind in read:
            raise BadInput.of(
                "file", str(file), f"the only {kind}", "One page shows one database and one run."
            )
        read[kind] = _read(file, kind)
    return Inputs(**read)


def file_kind(file: Path) -> str:
    """Return "database" or "run", by the attribute in which a file names its format.

    Raises
    ------
    BadInput
        The file is missing, no netCDF-4 file, or of another format.
    """
    if not file.is_file():
        raise BadInput.of("file", str(file), _BOUND, "There is no such file. Check the path.")
    try:
        with h5netcdf.File(file, "r") as content:
            named = {(name, str(content.attrs.get(name))) for name, _ in _KINDS}
    except (OSError, ValueError, RuntimeError, KeyError) as error:
        raise BadInput.of("file", str(file), _BOUND, f"It is no readable netCDF-4 file ({error}).") from None
    kinds = [kind for key, kind in _KINDS.items() if key in named]
    if not kinds:
        raise BadInput.of("file", str(file), _BOUND, "It is a netCDF file of another kind.")
    return kinds[0]


def _read(file: Path, kind: str) -> SteDatabase | RunResult:
    """Read a file of a known kind."""
    try:
        return SteDatabase.from_netcdf(file) if kind == "database" else RunResult.from_netcdf(file)
    except (FeContactError, DynamicsError) as error:
        raise BadInput.of("file", str(file), f"an undamaged {kind}", f"{error}.") from None
