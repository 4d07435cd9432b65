"""What a report is made from: a database, flank results, studies, a run; the files say which they are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5netcdf

from dynamics.errors import DynamicsError
from dynamics.linearize import ForcedResponse, ModalAnalysis
from dynamics.linearize.forced_response import SCHEMA as RESPONSE_SCHEMA
from dynamics.linearize.modal_analysis import SCHEMA as MODAL_SCHEMA
from dynamics.periodic import SteadyStates
from dynamics.periodic.steady_states import SCHEMA as STEADY_SCHEMA
from dynamics.results import RunResult
from fe_contact.analysis import LoadDistribution
from fe_contact.errors import FeContactError
from fe_contact.ste import SteDatabase
from service.convert.sensitivity import PairStudy
from service.convert.sensitivity_file import read_studies
from service.convert.stamp import stamped
from service.problems import BadInput
from service.report.page import Page
from service.report.stored_study import PAGES, stored_study

_KINDS = {
    ("format", "lineofaction STE database"): "database",
    ("format", "lineofaction flank results"): "flank results",
    ("format", "lineofaction sensitivity study"): "sensitivity study",
    ("schema", "lineofaction dynamics run"): "run",
    ("schema", MODAL_SCHEMA): "modal analysis",
    ("schema", RESPONSE_SCHEMA): "forced response",
    ("schema", STEADY_SCHEMA): "steady states",
}
_BOUND = (
    "an STE database, flank results, a study (sensitivity, modes, response, steady states; as JSON an "
    "ablation, a ladder, an optimisation, a tolerance Monte Carlo) or a run"
)
_READERS: dict[str, Callable[[Path], Any]] = {
    "database": SteDatabase.from_netcdf,
    "flank results": LoadDistribution.from_netcdf,
    "sensitivity study": read_studies,
    "run": RunResult.from_netcdf,
    "modal analysis": ModalAnalysis.from_netcdf,
    "forced response": ForcedResponse.from_netcdf,
    "steady states": SteadyStates.from_netcdf,
}
_FIELDS = {
    "database": "database",
    "flank results": "flanks",
    "sensitivity study": "studies",
    "run": "run",
    "modal analysis": "modal",
    "forced response": "response",
    "steady states": "steady",
}


@dataclass(frozen=True)
class Inputs:
    """What was read; at least one of them.

    `pages` are those of studies kept as JSON; `warnings` are those of all files, in words.
    """

    database: SteDatabase | None = None
    flanks: LoadDistribution | None = None
    studies: tuple[PairStudy, ...] = ()
    run: RunResult | None = None
    modal: ModalAnalysis | None = None
    response: ForcedResponse | None = None
    steady: SteadyStates | None = None
    pages: tuple[Page, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def only_page(self) -> Page | None:
        """The page of a study in JSON, if nothing else was read."""
        others = (self.database, self.flanks, self.run, self.modal, self.response, self.steady)
        alone = len(self.pages) == 1 and not self.studies and all(one is None for one in others)
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
    for file in files:
        if file.suffix == ".json" and file.is_file():
            kind, content = stored_study(file)
        else:
            kind = file_kind(file)
            content = _read(file, kind)
        if kind in read:
            advice = "One page shows one file of each kind."
            raise BadInput.of("file", str(file), f"the only {kind}", advice)
        read[kind] = content
    warnings = tuple(dict.fromkeys(one["message"] for file in files for one in stamped(file)))
    pages = tuple(read.pop(kind) for kind in PAGES if kind in read)
    return Inputs(
        **{_FIELDS[kind]: content for kind, content in read.items()}, pages=pages, warnings=warnings
    )


def file_kind(file: Path) -> str:
    """Return which kind a file is, one of `_READERS`, by the attribute in which it names its format.

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


def _read(file: Path, kind: str) -> Any:
    """Read a file of a known kind."""
    try:
        return _READERS[kind](file)
    except (FeContactError, DynamicsError) as error:
        raise BadInput.of("file", str(file), f"an undamaged {kind}", f"{error}.") from None
