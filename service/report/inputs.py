"""The inputs of a report: a database, flank results, studies, a run; the files say which they are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5netcdf

from dynamics.errors import DynamicsError
from dynamics.results import RunResult
from fe_contact.analysis import LoadDistribution
from fe_contact.errors import FeContactError
from fe_contact.ste import SteDatabase
from service.convert.sensitivity import PairStudy
from service.convert.sensitivity_file import read_studies
from service.convert.stamp import stamped
from service.problems import BadInput
from service.report.page import Page
from service.report.stored_study import marked_study, stored_study, study_page

_KINDS = {
    ("format", "lineofaction STE database"): "database",
    ("format", "lineofaction flank results"): "flank results",
    ("format", "lineofaction sensitivity study"): "sensitivity study",
    ("schema", "lineofaction dynamics run"): "run",
}
_BOUND = (
    "an STE database, flank results, a study (sensitivity, modes, response, steady states; as JSON an "
    "ablation, an accuracy study, an optimisation, a tolerance Monte Carlo) or a run"
)
_READERS: dict[str, Callable[[Path], Any]] = {
    "database": SteDatabase.from_netcdf,
    "flank results": LoadDistribution.from_netcdf,
    "sensitivity study": read_studies,
    "run": RunResult.from_netcdf,
}
_FIELDS = {
    "database": "database",
    "flank results": "flanks",
    "sensitivity study": "studies",
    "run": "run",
}


@dataclass(frozen=True)
class Inputs:
    """The results that were read; at least one of them.

    `pages` are those of studies; `warnings` are those of all files, in words.
    """

    database: SteDatabase | None = None
    flanks: LoadDistribution | None = None
    studies: tuple[PairStudy, ...] = ()
    run: RunResult | None = None
    pages: tuple[Page, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def only_page(self) -> Page | None:
        """The page of a study, if nothing else was read."""
        others = (self.database, self.flanks, self.run)
        alone = len(self.pages) == 1 and not self.studies and all(other is None for other in others)
        return self.pages[0] if alone else None


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
    pages: dict[str, Page] = {}
    for file in files:
        kind, content = _content(file)
        if kind in read or kind in pages:
            advice = "One page shows one file of each kind."
            raise BadInput.of("file", str(file), f"the only {kind}", advice)
        (read if kind in _FIELDS else pages)[kind] = content
    warnings = tuple(dict.fromkeys(warning["message"] for file in files for warning in stamped(file)))
    fields = {_FIELDS[kind]: content for kind, content in read.items()}
    return Inputs(**fields, pages=tuple(pages.values()), warnings=warnings)


def _content(file: Path) -> tuple[str, Any]:
    """Return the kind of a file, and what it holds; of a study the page."""
    if file.suffix == ".json" and file.is_file():
        return stored_study(file)
    attributes = _attributes(file)
    if study := marked_study(attributes):
        return study.kind, study_page(study, file)
    kinds = [kind for (name, value), kind in _KINDS.items() if attributes.get(name) == value]
    if not kinds:
        raise BadInput.of("file", str(file), _BOUND, "It is a netCDF file of another kind.")
    return kinds[0], _read(file, kinds[0])


def _attributes(file: Path) -> dict[str, str]:
    """Return the attributes of a netCDF file as texts.

    Raises
    ------
    BadInput
        The file is missing or no netCDF-4 file.
    """
    if not file.is_file():
        raise BadInput.of("file", str(file), _BOUND, "There is no such file. Check the path.")
    try:
        with h5netcdf.File(file, "r") as content:
            return {name: str(value) for name, value in content.attrs.items()}
    except (OSError, ValueError, RuntimeError, KeyError) as error:
        raise BadInput.of("file", str(file), _BOUND, f"It is no readable netCDF-4 file ({error}).") from None


def _read(file: Path, kind: str) -> Any:
    """Read a file of a known kind."""
    try:
        return _READERS[kind](file)
    except (FeContactError, DynamicsError) as error:
        raise BadInput.of("file", str(file), f"an undamaged {kind}", f"{error}.") from None
